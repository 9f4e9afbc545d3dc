"""What a planner returns."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from converter.plan import Plan, Segment, Status, Subgoal
from converter.scene import Scene
from planner.settings import Settings


@dataclass(frozen=True)
class Progress:
    """What a search reports while it runs.

    Attributes:
        expansions: Expansions so far.
        nodes: Configurations in the tree.
        best_score: The highest score of them.
        time_s: Wall time so far [s].
    """

    expansions: int
    nodes: int
    best_score: float
    time_s: float


@dataclass(frozen=True, eq=False)
class PlanResult:
    """Outcome of one search.

    Attributes:
        status: How it ended.
        time_s: Wall time [s].
        segments: The motion; empty unless solved.
        subgoals: The placement at the end of each carry, in order.
        certificate: With `infeasible`, what proves it; with `exhausted`, what ran out.
        counters: Work done. Keys that end in `_s` are times [s], which a seed does not fix: `subgoal_time_s` is the
            part of `time_s` spent on computing what subgoals are drawn from.
    """

    status: Status
    time_s: float
    segments: tuple[Segment, ...] = ()
    subgoals: tuple[Subgoal, ...] = ()
    certificate: str | None = None
    counters: Mapping[str, float] = field(default_factory=dict)

    def to_plan(self, scene: Scene, settings: Settings, seed: int) -> Plan:
        """The result as a plan file's content."""
        return Plan(
            scene=scene.name,
            scene_hash=scene.geometry_hash,
            method=settings.method,
            seed=seed,
            status=self.status,
            time_s=self.time_s,
            tolerance=scene.tolerance,
            settings=settings.as_document(),
            preset=scene.preset,
            certificate=self.certificate,
            counters=self.counters,
            subgoals=self.subgoals,
            segments=self.segments,
            scene_data=scene,
        )
