"""Pictures of search trees."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.raster import Image, paint
from converter.render_tree import MAX_EXPANDED, Mark, TreeNode, layout, tree_drawing, tree_width_px
from converter.scene import Scene

GREEN, RED = [41, 158, 69], [209, 51, 46]


def node(scene: Scene, parent: int | None, mark: Mark) -> TreeNode:
    """A node with everything where it starts."""
    return TreeNode(parent, scene.agent.position, np.array([body.position[:2] for body in scene.objects]), mark)


def tree(scene: Scene, *nodes: tuple[int | None, Mark]) -> list[TreeNode]:
    """A tree from parents and marks."""
    return [node(scene, parent, mark) for parent, mark in nodes]


def image_of(scene: Scene, nodes: list[TreeNode]) -> Image:
    """The picture of a tree."""
    drawing = tree_drawing(scene, nodes)
    return paint(drawing, tree_width_px(drawing))


def colors(image: Image) -> list[list[int]]:
    """All colours of an image."""
    return np.unique(image.reshape(-1, 3), axis=0).tolist()


@given(st.data())
def test_nodes_do_not_overlap(data: st.DataObject):
    """Whatever the tree, nodes of one row keep their widths' distance, below and centred under their parents."""
    size = data.draw(st.integers(1, 25))
    parents = [-1, *(data.draw(st.integers(0, i - 1)) for i in range(1, size))]
    widths = data.draw(st.lists(st.sampled_from([0.3, 1.2]), min_size=size, max_size=size))
    places = layout(parents, widths)
    for y in np.unique(places[:, 1]):
        row = np.flatnonzero(places[:, 1] == y)
        row = row[np.argsort(places[row, 0])]
        for a, b in pairwise(row):
            assert places[b, 0] - places[a, 0] >= (widths[a] + widths[b]) / 2 - 1e-9
    for i in range(1, size):
        assert places[i, 1] < places[parents[i], 1]


def test_a_parent_stands_above_the_middle_of_its_children():
    """Three equal children: the middle one is right below."""
    places = layout([-1, 0, 0, 0], [1.0, 1.0, 1.0, 1.0])
    assert places[:, 0].tolist() == [1.5, 0.5, 1.5, 2.5]


def test_frames_tell_solved_from_unsolved(small_room: Scene):
    """Green where the puzzle was solved, red where it was not; without a solution no green."""
    solved = image_of(
        small_room, tree(small_room, (None, Mark.UNSOLVED), (0, Mark.OPEN), (0, Mark.SOLVED), (2, Mark.SOLVED))
    )
    assert GREEN in colors(solved)
    assert RED in colors(solved)
    failed = image_of(small_room, tree(small_room, (None, Mark.UNSOLVED), (0, Mark.OPEN)))
    assert GREEN not in colors(failed)
    assert RED in colors(failed)


def test_a_frame_around_each_expanded_configuration(small_room: Scene):
    """The part of the picture that is red grows by the same amount with every unsolved configuration."""
    marks = [(None, Mark.UNSOLVED), (0, Mark.UNSOLVED), (0, Mark.UNSOLVED), (0, Mark.UNSOLVED)]
    pictures = [image_of(small_room, tree(small_room, *marks[:n])) for n in (3, 4)]
    red = [(picture == RED).all(axis=2).sum() for picture in pictures]
    assert red[1] / red[0] == pytest.approx(4 / 3, rel=0.1)


def test_large_trees_show_a_part(small_room: Scene):
    """A tree of hundreds of expanded nodes stays a picture of bounded size, and the way to the solution is in it."""
    wide = [(None, Mark.UNSOLVED), *((0, Mark.UNSOLVED) for _ in range(10 * MAX_EXPANDED))]
    image = image_of(small_room, tree(small_room, *wide, (len(wide) - 1, Mark.SOLVED), (len(wide), Mark.SOLVED)))
    assert image.shape[1] <= 4000
    assert GREEN in colors(image)


def test_a_tree_needs_a_root(small_room: Scene):
    """Without nodes there is nothing to draw."""
    with pytest.raises(ValueError, match="at least one node"):
        tree_drawing(small_room, [])
