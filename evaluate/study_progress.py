"""What a person sees of a study that runs for hours: trials done and left, how many are solved, what goes worst."""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from converter.plan import Status
from evaluate.output import Progress, counted
from evaluate.study import Study
from evaluate.trial_row import TrialRow

FIELD = "study"
"""Name of the field that a bar shows behind the time that remains."""

REFRESH_S = 0.2
"""Between two updates of the bar [s]; trials may end much faster."""


@dataclass
class _Tally:
    run: int = 0
    solved: int = 0
    time_s: float = 0.0

    @property
    def badness(self) -> tuple[float, float]:
        """Orders scenes: the share that is not solved, then the time that trials take."""
        return 1 - self.solved / self.run, self.time_s / self.run


class StudyProgress:
    """The progress of one call: trials that were run before count neither as done nor for the rate."""

    def __init__(self, bar: Progress, study: Study, clock: Callable[[], float] = time.monotonic) -> None:
        self._bar, self._study, self._clock = bar, study, clock
        self._left, self._all = study.size, _Tally()
        self._scenes: dict[str, _Tally] = {}
        self._errors: Counter[str] = Counter()
        self._first_errors: dict[str, str] = {}
        self._started = clock()
        self._shown = -REFRESH_S
        self._task = bar.add_task(study.name, total=study.size, study="")

    def on_trial(self, row: TrialRow | None) -> None:
        """Counts a trial; None is one that had been run before."""
        if row is None:
            self._left -= 1
        else:
            label = self._study.label(row.scene, row.preset)
            for tally in (self._all, self._scenes.setdefault(label, _Tally())):
                tally.run += 1
                tally.solved += row.verified is True
                tally.time_s += row.time_s
            if row.status == Status.ERROR:
                self._errors[row.method] += 1
                self._first_errors.setdefault(row.method, row.message or "")
        now = self._clock()
        if now - self._shown >= REFRESH_S or self._all.run == self._left:
            self._shown = now
            self._bar.update(self._task, total=self._left, completed=self._all.run, study=self.text())

    def errors(self) -> list[str]:
        """A line for each method of which trials ended with an error."""
        return [
            f"{method}: {counted(number, 'trial')} ended with an error, the first: {self._first_errors[method]}"
            for method, number in self._errors.items()
        ]

    def text(self) -> str:
        """Rate, number of solved trials, and the worst scene; empty before the first trial."""
        if not self._all.run:
            return ""
        name = max(self._scenes, key=lambda scene: self._scenes[scene].badness)
        worst = self._scenes[name]
        rate = _rate(self._all.run / max(self._clock() - self._started, 1e-9))
        mean = worst.time_s / worst.run
        return f"{rate}, solved {self._all.solved}/{self._all.run}, worst {name} {worst.solved}/{worst.run} in {mean:.2g} s"


def _rate(per_second: float) -> str:
    return f"{per_second:.3g}/s" if per_second >= 1 else f"{60 * per_second:.3g}/min"
