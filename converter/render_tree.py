"""Pictures of search trees: configurations as small pictures of the scene, joined to those they were reached from.

Green frames mark the configuration from which the puzzle was solved and the solution itself, red ones those from which
it was not (as Fig. 2 of Levit et al.); dots are configurations that were never expanded. Thick green lines lead to the
solution. In a large tree only the solution's ancestors and the first expanded configurations are shown.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from converter.drawing import Drawing, Inset, Item, Label, Line, Shape, box, disc, fitted
from converter.render_scene import scene_drawing
from converter.scene import Scene
from converter.shape import FloatArray
from converter.theme import PAPER, Color, Theme

MAX_EXPANDED = 40
"""Most small pictures of a tree."""

TILE_PX = 150
"""Width of a small picture, if the tree is not too wide for it."""

WIDTH_PX = (450, 4000)
"""Least and greatest width of an image."""

GAP, ROW, DOT = 0.2, 1.5, 0.09
"""Between tiles, from row to row, and radius of a dot, in tiles' widths."""

FRAME = 0.035
"""Width of frames and of the solution's lines, in tiles' widths."""


class Mark(Enum):
    """What became of a configuration."""

    SOLVED = "solved"
    UNSOLVED = "unsolved"
    OPEN = "never expanded"


_COLORS: dict[Mark, Callable[[Theme], Color]] = {
    Mark.SOLVED: lambda theme: theme.good,
    Mark.UNSOLVED: lambda theme: theme.bad,
    Mark.OPEN: lambda theme: theme.neutral,
}


@dataclass(frozen=True, eq=False)
class TreeNode:
    """A configuration in a tree.

    Attributes:
        parent: Index of the node it was reached from, which comes earlier; None for the root.
        agent: (2,) [m], world.
        objects: (n, 2) [m], world, in the order of the scene.
        mark: What became of it.
    """

    parent: int | None
    agent: FloatArray
    objects: FloatArray
    mark: Mark


def tree_width_px(drawing: Drawing) -> int:
    """The width that shows a tree's small pictures well."""
    return int(np.clip(TILE_PX * (drawing.upper - drawing.lower)[0], *WIDTH_PX))


def tree_drawing(scene: Scene, nodes: Sequence[TreeNode], *, theme: Theme = PAPER) -> Drawing:
    """The tree, the root (the first node) at the top; a small picture is a unit square.

    Raises:
        ValueError: there are no nodes.
    """
    if not nodes:
        raise ValueError("a tree needs at least one node")
    kept, solution = _shown(nodes), _ancestors(nodes)
    shown = [nodes[i] for i in kept]
    number = {node: i for i, node in enumerate(kept)}
    parents = [-1 if node.parent is None else number[node.parent] for node in shown]
    places = layout(parents, [1.0 + GAP if node.mark is not Mark.OPEN else 3 * DOT for node in shown])
    drawing = _drawing(shown, parents, places, {number[i] for i in solution}, _caption(nodes, kept), theme)
    tiles = [
        _tile(scene, node, place, theme)
        for node, place in zip(shown, places, strict=True)
        if node.mark is not Mark.OPEN
    ]
    return replace(drawing, items=(*drawing.items, *tiles))


def layout(parents: Sequence[int], widths: Sequence[float]) -> FloatArray:
    """Centres (n, 2) of the nodes: children side by side in their order, one row below, centred under their parent.

    Args:
        parents: Index of each node's parent, which comes earlier; -1 for the root, which is the first.
        widths: What each node takes of its row at least.
    """
    below = np.zeros(len(parents))
    taken = np.array(widths, dtype=np.float64)
    for i in range(len(parents) - 1, 0, -1):
        taken[i] = max(taken[i], below[i])
        below[parents[i]] += taken[i]
    taken[0] = max(taken[0], below[0])
    places = np.zeros((len(parents), 2))
    following = np.empty(len(parents))
    places[0, 0] = taken[0] / 2
    following[0] = (taken[0] - below[0]) / 2
    for i in range(1, len(parents)):
        parent = parents[i]
        places[i] = following[parent] + taken[i] / 2, places[parent, 1] - ROW
        following[i] = following[parent] + (taken[i] - below[i]) / 2
        following[parent] += taken[i]
    return places


def _ancestors(nodes: Sequence[TreeNode]) -> list[int]:
    """The last solved node and its ancestors up to the root; empty without a solution."""
    solved = [i for i, node in enumerate(nodes) if node.mark is Mark.SOLVED]
    index = solved[-1] if solved else None
    found = []
    while index is not None:
        found.append(index)
        index = nodes[index].parent
    return found


def _shown(nodes: Sequence[TreeNode]) -> list[int]:
    """The nodes to show, in order: some expanded ones with their ancestors, and the children of all these."""
    expanded = {0, *_ancestors(nodes)}
    for i, node in enumerate(nodes):
        if len(expanded) >= MAX_EXPANDED:
            break
        if node.mark is not Mark.OPEN and node.parent in expanded:
            expanded.add(i)
    leaves = (i for i, node in enumerate(nodes) if node.mark is Mark.OPEN and node.parent in expanded)
    return sorted({*expanded, *leaves})


def _caption(nodes: Sequence[TreeNode], kept: Sequence[int]) -> str:
    expanded = sum(node.mark is not Mark.OPEN for node in nodes)
    shown = sum(nodes[i].mark is not Mark.OPEN for i in kept)
    text = f"{len(nodes)} configurations, {expanded} expanded"
    return text if shown == expanded else f"{text}; {shown} of these shown"


def _drawing(
    shown: Sequence[TreeNode],
    parents: Sequence[int],
    places: FloatArray,
    solution: set[int],
    caption: str,
    theme: Theme,
) -> Drawing:
    """Lines, frames and dots, without the small pictures."""
    lines: list[Item] = []
    for i in sorted(range(1, len(shown)), key=lambda i: i in solution):
        width, color = (FRAME, theme.good) if i in solution else (FRAME / 3, theme.neutral)
        lines += [Line(piece, width, color) for piece in _connection(places[parents[i]], places[i])]
    marks: list[Item] = [
        Shape((disc(place, DOT),), theme.neutral)
        if node.mark is Mark.OPEN
        else Shape((box(place, (1.0 + 2 * FRAME, 1.0 + 2 * FRAME)),), _COLORS[node.mark](theme))
        for node, place in zip(shown, places, strict=True)
    ]
    left, right = places[:, 0].min() - 0.7, places[:, 0].max() + 0.7
    label = Label(caption, np.array([(left + right) / 2, 0.85]), 0.13, theme.outline)
    # Narrow trees leave room for the caption.
    spare = max(0.0, 3.0 - (right - left)) / 2
    lower, upper = np.array([left - spare, places[:, 1].min() - 0.7]), np.array([right + spare, 1.05])
    return Drawing(lower, upper, theme.page, (*lines, *marks, label))


def _connection(parent: FloatArray, child: FloatArray) -> list[FloatArray]:
    """Straight pieces (2, 2) down from the parent, across between the rows, and down to the child."""
    middle = parent[1] - ROW / 2
    corners = np.array([parent, [parent[0], middle], [child[0], middle], child])
    return [corners[i : i + 2] for i in range(3)]


def _tile(scene: Scene, node: TreeNode, place: FloatArray, theme: Theme) -> Inset:
    """The small picture of a node, as large as the unit square around `place` allows."""
    moved = replace(
        scene,
        agent=replace(scene.agent, position=node.agent),
        objects=tuple(body.at(xy) for body, xy in zip(scene.objects, node.objects, strict=True)),
    )
    return fitted(scene_drawing(moved, theme=theme), place, np.ones(2))
