"""Several results folders as one."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from evaluate.store import StoredTrials, TrialStore
from evaluate.study_record import StudyRecord
from pcg.errors import InputError

Value = TypeVar("Value")
MAX_NAME = 100
JOINT = " + "
"""Between the names of the studies that were merged."""


@dataclass(frozen=True)
class Merged:
    """What came together.

    Attributes:
        added: Trials that were copied.
        repeated: Trials that the target, or a folder before, held already; its row stays.
    """

    added: int
    repeated: int


def merge(sources: Sequence[Path], target: TrialStore) -> Merged:
    """Copies trials and scenes into `target`, whose study becomes that of all sources together.

    Run again after an interruption it goes on where it stopped.

    Raises:
        InputError: a source is no study's folder, or the target cannot be written.
    """
    records = _records(sources, target)
    added = repeated = 0
    for folder in sources:
        with StoredTrials(folder) as source:
            target.add_scenes(source.scenes())
            for row in source.rows():
                if row.key in target:
                    repeated += 1
                else:
                    target.add(row)
                    added += 1
    if records:
        united = _united(records)
        held = sum(united.includes(row) for row in target.rows(plans=False))
        target.set_study(replace(united, trials=held))
    return Merged(added, repeated)


def _records(sources: Sequence[Path], target: TrialStore) -> list[StudyRecord]:
    """What the studies of all folders consist of, the target's first; without those that say nothing.

    Raises:
        InputError: a source is no study's folder, or one method has different settings in two of them.
    """
    records = [target.study()]
    for folder in sources:
        with StoredTrials(folder) as source:
            records.append(source.study())
    found = [record for record in records if record is not None]
    settings: dict[str, str] = {}
    for name, hash_ in (method for record in found for method in record.methods):
        if settings.setdefault(name, hash_) != hash_:
            raise InputError("merge", f"the settings of method {name!r} differ between the folders; name it otherwise")
    return found


def _united(records: Sequence[StudyRecord]) -> StudyRecord:
    """The study of all scenes, methods and seeds; its number of trials is left open."""
    names = dict.fromkeys(name for record in records for name in record.name.split(JOINT))
    return replace(
        records[0],
        name=JOINT.join(names)[:MAX_NAME],
        scenes=_distinct(scene for record in records for scene in record.scenes),
        methods=_distinct(method for record in records for method in record.methods),
        seeds=_distinct(seed for record in records for seed in record.seeds),
        trials=0,
    )


def _distinct(values: Iterable[Value]) -> tuple[Value, ...]:
    return tuple(dict.fromkeys(values))
