"""The search tree and its queues."""

from planner.logic import Action, Domain, Surface
from planner.mbts_tree import Queue, TreeNode

DOMAIN = Domain(1, 0)


def chain() -> tuple[TreeNode, TreeNode, TreeNode]:
    """The root, its child after a pick, and the child of that after the placement."""
    root = TreeNode(DOMAIN.initial)
    pick, place = Action(0), Action(0, Surface.GOAL)
    picked = TreeNode(DOMAIN.successor(root.state, pick), root, pick)
    return root, picked, TreeNode(DOMAIN.successor(picked.state, place), picked, place)


def test_a_node_knows_its_actions():
    """The path leaves the root out, the skeleton has the actions in order."""
    root, picked, placed = chain()
    assert root.path == []
    assert root.skeleton == ()
    assert placed.path == [picked, placed]
    assert placed.skeleton == (Action(0), Action(0, Surface.GOAL))


def test_an_infeasible_node_prunes_its_subtree_only():
    """Descendants are pruned, also those that come later; ancestors and siblings are not."""
    root, picked, placed = chain()
    sibling = TreeNode(DOMAIN.initial, root, Action(0))
    picked.infeasible = True
    assert [node.pruned for node in (root, picked, placed, sibling)] == [False, True, True, False]


def test_long_sequences():
    """The setting that bounds their length may be larger than the interpreter's stack."""
    node = TreeNode(DOMAIN.initial)
    for _ in range(5000):
        node = TreeNode(DOMAIN.initial, node, Action(0))
    assert len(node.skeleton) == 5000
    assert not node.pruned
    node.path[0].infeasible = True
    assert node.pruned


def test_the_cheapest_node_goes_first_and_of_equals_the_oldest():
    """Costs decide, then the order of entry."""
    queue, nodes = Queue(), [TreeNode(DOMAIN.initial) for _ in range(4)]
    for node, cost in zip(nodes, [2.0, 1.0, 2.0, 1.0], strict=True):
        queue.push(node, cost)
    assert len(queue) == 4
    assert [queue.pop() for _ in range(5)] == [nodes[1], nodes[3], nodes[0], nodes[2], None]


def test_pruned_nodes_never_leave_a_queue():
    """A node that was pruned while it waited does not count and is passed over."""
    _, picked, placed = chain()
    queue, other = Queue(), TreeNode(DOMAIN.initial)
    queue.push(placed, 1.0)
    queue.push(other, 2.0)
    picked.infeasible = True
    assert len(queue) == 1
    assert queue.pop() is other
    assert queue.pop() is None
