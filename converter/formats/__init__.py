"""Scene files: reading and writing by the suffix of the path."""

from pathlib import Path

from converter.formats.scene_yaml import read_scene_yaml, write_scene_yaml
from converter.scene import Scene
from pcg.errors import InputError


def _read_rai_g(path: Path) -> Scene:
    from converter.formats.rai_g import read_rai_g  # noqa: PLC0415  # most programs never read a .g file

    return read_rai_g(path)


def _write_rai_g(path: Path, scene: Scene) -> None:
    from converter.formats.rai_g_export import write_rai_g  # noqa: PLC0415  # most programs never write a .g file

    write_rai_g(path, scene)


def _write_mjcf(path: Path, scene: Scene) -> None:
    from converter.formats.mjcf import write_mjcf  # noqa: PLC0415  # most programs never write a model

    write_mjcf(path, scene)


_READERS = {".yaml": read_scene_yaml, ".yml": read_scene_yaml, ".g": _read_rai_g}
_WRITERS = {".yaml": write_scene_yaml, ".yml": write_scene_yaml, ".g": _write_rai_g, ".xml": _write_mjcf}


def read_scene(path: Path) -> Scene:
    """Reads the scene file at `path`.

    Raises:
        InputError: the suffix is unknown, or the file is not a valid scene.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(str(path), f"not a scene file: the suffix must be one of {' '.join(_READERS)}")
    return reader(path)


def write_scene(path: Path, scene: Scene) -> None:
    """Writes `scene` in the format that the suffix of `path` names.

    Raises:
        InputError: the suffix is unknown, or the file cannot be written.
    """
    writer = _WRITERS.get(path.suffix.lower())
    if writer is None:
        raise InputError(str(path), f"scenes are written as {' '.join(_WRITERS)}")
    writer(path, scene)
