"""`manipuzzle subgoals`: the subgoals that a method proposes for an object at the start, as a picture."""

from collections import Counter

import numpy as np

from converter.render_subgoals import subgoals_drawing
from converter.scene import Scene
from converter.theme import theme_named
from evaluate.commands.options import (
    ForwardSearch,
    Json,
    ObjectName,
    Out,
    SceneFile,
    Seed,
    SettingsName,
    Still,
    Theme,
    application,
)
from evaluate.inputs import read_scene_file, require_choice, require_writable
from evaluate.names import safe_name
from evaluate.output import print_json, print_line
from evaluate.picture_files import require_still, write_drawing
from evaluate.trial import require_plannable
from pcg.errors import InputError
from planner import Settings, settings_for
from planner.problem import Problem
from planner.subgoals import GENERATORS, Proposal, propose_subgoals
from planner.subproblems import subproblem_solvers

app = application()

WIDTH_PX = 1200
"""Width of the picture."""


@app.command()
def run(
    scene: SceneFile,
    *,
    out: Out,
    object_: ObjectName = None,
    method: ForwardSearch = "Rnd+FPR",
    seed: Seed = 0,
    settings: SettingsName = "fast",
    format_: Still = "png",
    theme: Theme = "paper",
    json: Json = False,
) -> bool:
    """Draw the subgoals that a method proposes for an object at the start, before and after the filter.

    Example:  manipuzzle subgoals data/puzzles/wall.yaml --method Btl+FPR --out out/pictures
    """
    require_still(format_)
    colors = theme_named(theme)
    of_planner = settings_for(settings, method=method)
    start = read_scene_file(scene)
    require_plannable(start, of_planner, str(scene))
    name = start.goal.object if object_ is None else object_
    proposal = proposal_at_start(start, of_planner, name, seed)
    require_writable(out)
    file = out / f"{safe_name(start.name)}-{safe_name(method)}-{safe_name(name)}-{seed}.{format_}"
    found = (proposal.candidates, proposal.scores, proposal.passed, proposal.drawn)
    write_drawing(file, subgoals_drawing(start, *found, theme=colors), WIDTH_PX, f"subgoals of {name} in {start.name}")
    if json:
        print_json(
            {
                "scene": start.name,
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
