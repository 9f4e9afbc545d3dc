"""`manipuzzle tree`: the search tree of a method on a scene, as a picture."""

from typing import Annotated

import numpy as np
import typer

from converter.render_tree import Mark, TreeNode, tree_drawing, tree_width_px
from converter.theme import theme_named
from evaluate.commands.options import ForwardSearch, Json, Out, SceneFile, Seed, SettingsName, Still, Theme, application
from evaluate.inputs import read_scene_file, require_writable
from evaluate.names import safe_name
from evaluate.output import print_json, print_line
from evaluate.picture_files import require_still, write_drawing
from evaluate.trial import require_plannable
from pcg.errors import InputError
from planner import settings_for
from planner.problem import Problem
from planner.search import Search
from planner.subgoals import GENERATORS

app = application()


@app.command()
def run(
    scene: SceneFile,
    *,
    out: Out,
    method: ForwardSearch = "Rnd+FPR",
    seed: Seed = 0,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", max=1e9, help="Planning time at most.")] = 60.0,
    settings: SettingsName = "fast",
    format_: Still = "png",
    theme: Theme = "paper",
    json: Json = False,
) -> bool:
    """Plan as `solve` does and draw the search tree. Exit status 1 if the scene is not solved.

    Example:  manipuzzle tree data/puzzles/wall.yaml --out out/pictures
    """
    require_still(format_)
    colors = theme_named(theme)
    of_planner = settings_for(settings, method=method, time_limit=time_limit)
    start = read_scene_file(scene)
    if of_planner.generator not in GENERATORS:
        raise InputError("--method", f"{method} is no forward search; {', '.join(GENERATORS)} are")
    require_plannable(start, of_planner, str(scene))
    require_writable(out)
    search = Search(Problem(start), of_planner, np.random.default_rng(np.random.SeedSequence(seed)))
    result = search.run()
    tree = tree_of(search)
    file = out / f"{safe_name(start.name)}-{safe_name(method)}-{seed}-tree.{format_}"
    drawing = tree_drawing(start, tree, theme=colors)
    write_drawing(file, drawing, tree_width_px(drawing), f"search tree of {method} in {start.name}")
    expanded = sum(node.mark is not Mark.OPEN for node in tree)
    if json:
        document = {"scene": start.name, "status": result.status.value, "nodes": len(tree), "expanded": expanded}
        print_json({**document, "file": str(file)})
    else:
        print_line(f"{start.name}: {result.status.value}; {len(tree)} configurations, {expanded} expanded; {file}")
    return search.solution is not None


def tree_of(search: Search) -> list[TreeNode]:
    """The tree of a finished search, with its solution as the last node."""
    nodes, solution = list(search.nodes), search.solution
    if solution is not None and solution not in nodes:
        nodes.append(solution)
    number = {node: i for i, node in enumerate(nodes)}
    solved = set() if solution is None else {solution, solution.parent}
    return [
        TreeNode(
            None if node.parent is None else number[node.parent],
            node.configuration.agent,
            node.configuration.objects,
            Mark.SOLVED if node in solved else Mark.UNSOLVED if node.expansions else Mark.OPEN,
        )
        for node in nodes
    ]
