"""What commands read: scenes, levels and plans, all of them before the work begins."""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from converter.formats import read_scene
from converter.plan import Plan, read_plan
from converter.preset import with_preset, with_tolerance
from converter.scene import Scene
from evaluate.names import require_distinct, safe_name
from pcg.errors import InputError
from pcg.level import Level
from pcg.level_set import iter_level_set
from planner.verify import require_same_scene

SCENE_SUFFIXES = (".yaml", ".yml", ".g")
PLAN_SUFFIXES = (".json",)


def is_scene(path: Path) -> bool:
    """Whether `path` names a scene file, by its suffix."""
    return path.suffix.lower() in SCENE_SUFFIXES


def is_plan(path: Path) -> bool:
    """Whether `path` names a plan file, by its suffix; what is neither scene nor plan is taken for levels."""
    return path.suffix.lower() in PLAN_SUFFIXES


def require_choice(option: str, value: str, allowed: Sequence[str]) -> None:
    """Refuses an option's value that is not allowed.

    Raises:
        InputError: naming the allowed ones.
    """
    if value not in allowed:
        raise InputError(option, f"found {value!r}, allowed are {', '.join(allowed)}")


def require_writable(folder: Path) -> None:
    """Makes the folder for results, before work is spent on them.

    Raises:
        InputError: it cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(str(folder), f"cannot be written: {error.strerror}") from None


def read_scene_file(path: Path, preset: str | None = None, tolerance: float | None = None) -> Scene:
    """The scene at `path`, called after its file.

    Args:
        path: The file.
        preset: Geometry preset to change it to; None keeps its geometry.
        tolerance: Penetration that counts as touching [m]; None keeps the scene's.

    Raises:
        InputError: the file is no valid scene, or preset or tolerance are not allowed.
    """
    return adapted(replace(read_scene(path), name=path.stem), preset, tolerance)


def adapted(scene: Scene, preset: str | None, tolerance: float | None) -> Scene:
    """The scene with the geometry of a preset and another tolerance [m]; None keeps what it has."""
    scene = scene if preset is None else with_preset(scene, preset)
    return scene if tolerance is None else with_tolerance(scene, tolerance)


def read_scenes(paths: Sequence[Path], preset: str | None = None, tolerance: float | None = None) -> list[Scene]:
    """The scenes of several files with different names; see `read_scene_file`."""
    scenes = [read_scene_file(path, preset, tolerance) for path in paths]
    require_distinct([safe_name(scene.name) for scene in scenes], "scenes")
    return scenes


def read_plan_with_scene(path: Path, given: Scene | None = None) -> tuple[Plan, Scene]:
    """The plan at `path` and the scene that it was made for.

    Args:
        path: The plan's file.
        given: The scene of a plan whose file holds none.

    Raises:
        InputError: the file is no valid plan, holds no scene, or `given` is another scene than the plan's.
    """
    plan = read_plan(path)
    if given is not None:
        require_same_scene(given, plan, str(path))
        return plan, given
    if plan.scene_data is None:
        raise InputError(str(path), "the file holds no scene; name the scene's file by --scene")
    return plan, plan.scene_data


def read_playable_levels(path: Path) -> list[Level]:
    """The levels of an XSB file or of a level set's folder.

    Raises:
        InputError: naming file, line or level, and reason.
    """
    return list(iter_playable_levels(path))


def iter_playable_levels(path: Path) -> Iterator[Level]:
    """The levels of `read_playable_levels` one by one, so that they need not all be held.

    Raises:
        InputError: naming file, line or level, and reason, when that level is reached.
    """
    for level in iter_level_set(path):
        level.require_playable(f"{path}: level {level.name!r}")
        yield level
