"""Two results folders trial by trial, and what two runs of one trial may differ in."""

import json
import statistics
from dataclasses import dataclass, field, replace
from typing import Any

from evaluate.packed import unpacked
from evaluate.store import StoredTrials
from evaluate.trial_row import TrialRow
from pcg import json_text


def without_times(row: TrialRow) -> TrialRow:
    """The row without what a seed does not fix: times, machine and versions; the plan uncompressed likewise.

    Raises:
        InputError: what is stored is damaged.
    """
    plan, where = None, f"trial {row.key}"
    if row.plan is not None:
        document = unpacked(row.plan, where)
        document["time_s"] = 0.0
        document["counters"] = _counted(document.get("counters"), where)
        plan = json.dumps(document, sort_keys=True).encode()
    counters = json.dumps(_counted(json_text.parse(row.counters, where), where), sort_keys=True)
    return replace(row, time_s=0.0, counters=counters, plan=plan, versions="", machine="", started="", finished="")


def same_plan(one: TrialRow, other: TrialRow) -> bool:
    """Whether two rows hold the same motion, or both none."""
    return one.plan == other.plan or without_times(one).plan == without_times(other).plan


def _counted(counters: Any, where: str) -> dict[str, Any]:
    """Counters without times, whose names end in `_s`."""
    found = json_text.require_object(counters, f"{where}: counters")
    return {name: value for name, value in found.items() if not name.endswith("_s")}


@dataclass
class Comparison:
    """What two folders say about one method on the same scenes with the same seeds.

    Attributes:
        both: Trials that both hold.
        same_plans: Of these, those with the same plan, or both without.
        solved: Of these, those that the first and the second solved.
        only_first: Solved by the first alone.
        only_second: Solved by the second alone.
        ratios: Planning time of the second by that of the first, of trials that both solved.
    """

    both: int = 0
    same_plans: int = 0
    solved: list[int] = field(default_factory=lambda: [0, 0])
    only_first: int = 0
    only_second: int = 0
    ratios: list[float] = field(default_factory=list)

    def add(self, first: TrialRow, second: TrialRow) -> None:
        """Counts a trial that both hold."""
        verdicts = first.verified is True, second.verified is True
        self.both += 1
        self.same_plans += same_plan(first, second)
        self.solved[0] += verdicts[0]
        self.solved[1] += verdicts[1]
        self.only_first += verdicts == (True, False)
        self.only_second += verdicts == (False, True)
        if all(verdicts) and first.time_s > 0:
            self.ratios.append(second.time_s / first.time_s)

    @property
    def time_ratio(self) -> float | None:
        """Median of `ratios`; None without trials that both solved."""
        return statistics.median(self.ratios) if self.ratios else None


@dataclass
class FolderComparison:
    """What two folders have in common.

    Attributes:
        methods: By name, where both hold trials of it.
        first_alone: Trials that only the first holds.
        second_alone: Trials that only the second holds.
    """

    methods: dict[str, Comparison] = field(default_factory=dict)
    first_alone: int = 0
    second_alone: int = 0

    @property
    def agree(self) -> bool:
        """Whether all trials that both hold ended alike: solved, or not."""
        return not any(each.only_first or each.only_second for each in self.methods.values())


def compare(first: StoredTrials, second: StoredTrials) -> FolderComparison:
    """Compares trials on the same scene, in name and geometry, with the same method, by name, and the same seed.

    Their settings may differ: that is what folders are compared for. Where a folder holds such a trial with several
    settings, the latest counts.
    """
    places = _places(first)
    found = FolderComparison()
    for place, key in _places(second).items():
        if place not in places:
            found.second_alone += 1
            continue
        one, other = first.get(places.pop(place)), second.get(key)
        found.methods.setdefault(one.method, Comparison()).add(one, other)
    found.first_alone = len(places)
    return found


def _places(store: StoredTrials) -> dict[tuple[str, str, str, int], str]:
    """The key of the latest row for each scene, method and seed."""
    return {(row.scene, row.scene_hash, row.method, row.seed): row.key for row in store.rows(plans=False)}
