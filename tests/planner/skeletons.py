"""All skeletons of a domain, by plain enumeration."""

from collections import deque
from collections.abc import Iterator

from planner.logic import Domain, Skeleton, SymbolicState


def skeletons(domain: Domain, max_length: int) -> Iterator[Skeleton]:
    """Every skeleton of at most `max_length` actions that solves the puzzle symbolically, breadth first.

    Nothing follows after the goal is reached, so no skeleton begins with another one.
    """
    queue: deque[tuple[Skeleton, SymbolicState]] = deque([((), domain.initial)])
    while queue:
        skeleton, state = queue.popleft()
        if len(skeleton) == max_length:
            continue
        for action in domain.actions(state):
            extended, following = (*skeleton, action), domain.successor(state, action)
            if domain.is_solved(following):
                yield extended
            else:
                queue.append((extended, following))
