"""Plans that arguments of commands name: plan files, folders of them, and single trials of studies as DIR#KEY."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from converter.plan import Plan, read_plan
from converter.scene import Scene
from evaluate.inputs import PLAN_SUFFIXES, expanded, is_plan
from evaluate.names import safe_name
from evaluate.record import plan_of
from evaluate.store import FILE_NAME, StoredTrials
from evaluate.trial_row import TrialRow
from pcg.errors import InputError
from planner.verify import require_same_scene

SEPARATOR = "#"
"""Between the folder of a study and the beginning of a trial's key."""


@dataclass(frozen=True, eq=False)
class NamedPlan:
    """A plan and where it comes from.

    Attributes:
        where: What messages call it: its file, or its trial.
        name: Stem of files made from it.
        plan: The plan.
    """

    where: str
    name: str
    plan: Plan

    def scene(self, given: Scene | None, how: str = "by --scene") -> Scene:
        """The scene that the plan was made for: `given` if there is one, or what its file holds.

        Args:
            given: The scene that the user names.
            how: How the user could name one, for the message.

        Raises:
            InputError: `given` is another scene than the plan's, or there is none.
        """
        if given is not None:
            require_same_scene(given, self.plan, self.where)
            return given
        if self.plan.scene_data is None:
            raise InputError(self.where, f"the file holds no scene; name the scene's file {how}")
        return self.plan.scene_data


def names_plan(path: Path) -> bool:
    """Whether an argument names a plan: a file by its suffix, or a trial of a study."""
    return is_plan(path) or _folder_of_trial(path) is not None


def read_plans(paths: Sequence[Path]) -> Iterator[NamedPlan]:
    """The plans that arguments name, one after the other.

    Raises:
        InputError: one is no plan file, a folder holds none, or a study has no such trial or no plan of it.
    """
    for path in expanded(paths, PLAN_SUFFIXES):
        yield read_named_plan(path)


def read_named_plan(path: Path) -> NamedPlan:
    """The plan at `path`, a plan file or a trial of a study.

    Raises:
        InputError: as `read_plans`.
    """
    if (folder := _folder_of_trial(path)) is not None:
        return _plan_of_trial(folder, path.name.rpartition(SEPARATOR)[2], str(path))
    if not is_plan(path):
        raise InputError(str(path), f"not a plan: a plan is a .json file or a trial of a study, DIR{SEPARATOR}KEY")
    return NamedPlan(str(path), path.stem, read_plan(path))


def plan_name(row: TrialRow) -> str:
    """Stem of a plan's file: the trial's key tells equal names in two geometries apart."""
    return "-".join([safe_name(row.scene), safe_name(row.method), str(row.seed), row.key[:6]])


def _folder_of_trial(path: Path) -> Path | None:
    name, separator, _ = path.name.rpartition(SEPARATOR)
    folder = path.with_name(name) if name else path.parent
    return folder if separator and (folder / FILE_NAME).is_file() else None


def _plan_of_trial(folder: Path, key: str, where: str) -> NamedPlan:
    with StoredTrials(folder) as store:
        rows = store.find(key) if key else []
    if len(rows) != 1:
        problem = f"{len(rows)} trials have keys that begin so; " if rows else "no such trial; "
        raise InputError(where, f"{problem}`manipuzzle trials {folder}` lists them")
    plan = plan_of(rows[0])
    if plan is None or not plan.solved:
        raise InputError(where, f"the trial has no plan: {rows[0].message or rows[0].status}")
    return NamedPlan(where, plan_name(rows[0]), plan)
