"""What commands read: scenes, levels and plans, all of them before the work begins."""

import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from converter.formats import read_scene
from converter.preset import with_preset, with_tolerance
from converter.scene import Scene
from evaluate.names import counting_order, require_distinct, safe_name
from pcg.errors import InputError
from pcg.level import Level
from pcg.level_set import LEVELS_FILE, iter_level_set

SCENE_SUFFIXES = (".yaml", ".yml", ".g")
PLAN_SUFFIXES = (".json",)


def is_scene(path: Path) -> bool:
    """Whether `path` names a scene file, by its suffix."""
    return path.suffix.lower() in SCENE_SUFFIXES


def is_plan(path: Path) -> bool:
    """Whether `path` names a plan file, by its suffix; what is neither scene nor plan is taken for levels."""
    return path.suffix.lower() in PLAN_SUFFIXES


def is_level_set(path: Path) -> bool:
    """Whether `path` is the folder of a level set."""
    return (path / LEVELS_FILE).is_file()


def expanded(paths: Iterable[Path], suffixes: Sequence[str]) -> Iterator[Path]:
    """The files that arguments name: a folder stands for the files in it with one of these suffixes, in counting order.

    Raises:
        InputError: a folder holds none.
    """
    for path in paths:
        if not path.is_dir():
            yield path
            continue
        files = (file for file in path.iterdir() if file.suffix.lower() in suffixes and file.name[0] != ".")
        found = sorted(files, key=lambda file: counting_order(file.name))
        if not found:
            hint = f"; convert this level set first: manipuzzle convert {path} --out DIR" if is_level_set(path) else ""
            raise InputError(
                str(path), f"the folder holds no file {', '.join(f'*{suffix}' for suffix in suffixes)}{hint}"
            )
        yield from found


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


def read_scenes(paths: Sequence[Path], preset: str | None = None, tolerance: float | None = None) -> dict[Path, Scene]:
    """The scenes of several files and folders by their files, with different names; see `read_scene_file`."""
    files = list(expanded(paths, SCENE_SUFFIXES))
    scenes = [read_scene_file(path, preset, tolerance) for path in files]
    require_distinct([safe_name(scene.name) for scene in scenes], "scenes", [str(file) for file in files])
    return dict(zip(files, scenes, strict=True))


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
    if path.is_dir() and not is_level_set(path):
        raise InputError(str(path), f"no level set: the folder holds no {LEVELS_FILE}; name files of levels one by one")
    for level in iter_level_set(path):
        level.require_playable(f"{path}: level {level.name!r}")
        yield level
