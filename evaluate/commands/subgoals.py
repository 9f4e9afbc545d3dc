"""`manipuzzle subgoals`: the subgoals that a method proposes for an object at the start, as a picture."""

from collections import Counter
from pathlib import Path

import numpy as np

from converter.render_subgoals import subgoals_drawing
from converter.scene import Scene
from converter.theme import theme_named
from evaluate.inputs import read_scene_file, require_choice, require_writable
from evaluate.names import safe_name
from evaluate.output import print_json, print_line
from evaluate.picture_files import require_still, write_drawing
from evaluate.trial import require_plannable
from pcg.errors import InputError
from planner import Settings
from planner.problem import Problem
from planner.subgoals import GENERATORS, Proposal, propose_subgoals
from planner.subproblems import subproblem_solvers

WIDTH_PX = 1200
"""Width of the picture."""


def proposal_at_start(scene: Scene, settings: Settings, name: str, seed: int) -> Proposal:
    """What the method of `settings` proposes for object `name` where the scene starts.

    Raises:
        InputError: the method has no subgoals, there is no such object, or the agent cannot reach it.
    """
    require_choice("--object", name, scene.object_names)
    if settings.generator not in GENERATORS:
        raise InputError("--method", f"{settings.method} proposes no subgoals; {', '.join(GENERATORS)} do")
    problem, index = Problem(scene), scene.object_names.index(name)
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    generator = GENERATORS[settings.generator](problem, settings)
    solver = subproblem_solvers(problem, settings, rng, Counter(), lambda: False)(problem.initial)
    if not solver.reachable(index):
        raise InputError(scene.name, f"the agent cannot reach object {name!r}, so it gets no subgoals")
    return propose_subgoals(
        problem, generator, problem.initial, index, lambda at: solver.placeable(index, at), settings, rng
    )


def run(
    path: Path,
    out: Path,
    settings: Settings,
    seed: int,
    object_: str | None,
    *,
    format_: str,
    theme: str,
    as_json: bool,
) -> bool:
    """Runs the command; see `evaluate.cli.subgoals`."""
    require_still(format_)
    colors = theme_named(theme)
    scene = read_scene_file(path)
    require_plannable(scene, settings, str(path))
    name = scene.goal.object if object_ is None else object_
    proposal = proposal_at_start(scene, settings, name, seed)
    require_writable(out)
    file = out / f"{safe_name(scene.name)}-{safe_name(settings.method)}-{safe_name(name)}-{seed}.{format_}"
    found = (proposal.candidates, proposal.scores, proposal.passed, proposal.drawn)
    write_drawing(file, subgoals_drawing(scene, *found, theme=colors), WIDTH_PX, f"subgoals of {name} in {scene.name}")
    if as_json:
        print_json(
            {
                "scene": scene.name,
                "object": name,
                "candidates": len(proposal.candidates),
                "passed": len(proposal.passed),
                "subgoals": proposal.subgoals.tolist(),
                "file": str(file),
            }
        )
    else:
        counts = f"{len(proposal.candidates)} candidates, {len(proposal.passed)} passed, {len(proposal.drawn)} drawn"
        print_line(f"{name}: {counts}; picture in {file}")
    return True
