"""`manipuzzle tree`: the search tree of a method on a scene, as a picture."""

from pathlib import Path

import numpy as np

from converter.render_tree import Mark, TreeNode, tree_drawing, tree_width_px
from converter.theme import theme_named
from evaluate.inputs import read_scene_file, require_writable
from evaluate.names import safe_name
from evaluate.output import print_json, print_line
from evaluate.picture_files import require_still, write_drawing
from evaluate.trial import require_plannable
from pcg.errors import InputError
from planner import Settings
from planner.problem import Problem
from planner.search import Search
from planner.subgoals import GENERATORS


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


def run(path: Path, out: Path, settings: Settings, seed: int, *, format_: str, theme: str, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.tree`."""
    require_still(format_)
    colors = theme_named(theme)
    scene = read_scene_file(path)
    if settings.generator not in GENERATORS:
        raise InputError("--method", f"{settings.method} is no forward search; {', '.join(GENERATORS)} are")
    require_plannable(scene, settings, str(path))
    require_writable(out)
    search = Search(Problem(scene), settings, np.random.default_rng(np.random.SeedSequence(seed)))
    result = search.run()
    tree = tree_of(search)
    file = out / f"{safe_name(scene.name)}-{safe_name(settings.method)}-{seed}-tree.{format_}"
    drawing = tree_drawing(scene, tree, theme=colors)
    write_drawing(file, drawing, tree_width_px(drawing), f"search tree of {settings.method} in {scene.name}")
    expanded = sum(node.mark is not Mark.OPEN for node in tree)
    if as_json:
        document = {"scene": scene.name, "status": result.status.value, "nodes": len(tree), "expanded": expanded}
        print_json({**document, "file": str(file)})
    else:
        print_line(f"{scene.name}: {result.status.value}; {len(tree)} configurations, {expanded} expanded; {file}")
    return search.solution is not None
