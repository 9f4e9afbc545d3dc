"""`manipuzzle convert`: levels and scenes to scene files.

All inputs are read twice: first to refuse what cannot be used before any work is done, then one by one. So memory does
not grow with the number of levels, but for their names.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from converter.convert import ConversionSettings, convert_level
from converter.formats import write_scene
from converter.formats.mjcf import Movable, write_mjcf
from converter.preset import CLEAR, PRESETS
from converter.scene import Scene
from evaluate.commands.options import Json, Out, Tolerance, Workers, application
from evaluate.inputs import (
    SCENE_SUFFIXES,
    adapted,
    expanded,
    is_level_set,
    is_scene,
    iter_playable_levels,
    read_scene_file,
    require_choice,
    require_writable,
)
from evaluate.names import require_distinct, safe_name
from evaluate.output import counted, print_json, print_line, print_table, progress
from evaluate.parallel import in_order
from pcg.errors import InputError
from pcg.level import Level

app = application()


@app.command()
def run(
    inputs: Annotated[
        list[Path], typer.Argument(metavar="LEVEL|SCENE", help="XSB files, level sets, scene files, folders of these.")
    ],
    *,
    out: Out,
    to: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Format of the scenes: yaml, g (rai), mjcf (MuJoCo) or mjcf-mocap, in which a program moves the objects.",
        ),
    ] = "yaml",
    preset: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Geometry: clear (default for levels) or published.", show_default=False),
    ] = None,
    tolerance: Tolerance = None,
    cell: Annotated[float, typer.Option(metavar="METRES", help="Side of a cell.")] = 0.4,
    agent_radius: Annotated[
        float | None, typer.Option(metavar="METRES", help="By default that of the preset.", show_default=False)
    ] = None,
    agent_height: Annotated[float, typer.Option(metavar="METRES", help="Height of the agent.")] = 0.2,
    object_size: Annotated[float, typer.Option(metavar="METRES", help="Side of the box that a crate becomes.")] = 0.2,
    object_height: Annotated[
        float | None, typer.Option(metavar="METRES", help="By default objects are cubes.", show_default=False)
    ] = None,
    goal_size: Annotated[float, typer.Option(metavar="METRES", help="Side of the goal.")] = 0.35,
    wall_height: Annotated[float, typer.Option(metavar="METRES", help="Height of all walls.")] = 0.4,
    merge_walls: Annotated[
        bool, typer.Option("--merge-walls", help="Make adjacent wall cells the fewest bodies that fill the same space.")
    ] = False,
    size_jitter: Annotated[
        float, typer.Option(metavar="SHARE", help="Make each side of each object up to this share longer or shorter.")
    ] = 0.0,
    yaw_jitter: Annotated[
        float, typer.Option(metavar="RADIANS", help="Turn each object by up to this angle, either way.")
    ] = 0.0,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the jitter.")] = 0,
    goal_crate: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Crate, counted from 1 in reading order, that becomes the goal-object; by default the one that the "
            "level set names or the solver brings to the goal.",
            show_default=False,
        ),
    ] = None,
    drop_targets: Annotated[
        bool, typer.Option("--drop-targets", help="Remove all targets but the first, which is the goal.")
    ] = False,
    drop_crates: Annotated[
        bool, typer.Option("--drop-crates", help="Remove all crates but the goal crate, and the surplus targets.")
    ] = False,
    workers: Workers = 1,
    json: Json = False,
) -> bool:
    """Convert levels and scenes to scene files DIR/{name}.yaml, .g, or .xml for MuJoCo.

    Of the options only --to, --preset and --tolerance apply to scenes. A level's scene records all of them.

    Example:  manipuzzle convert out/levels --out out/scenes --merge-walls --yaw-jitter 0.5 --seed 1
    """
    conversion = conversion_of(
        out,
        to,
        preset,
        tolerance,
        cell=cell,
        wall_height=wall_height,
        object_size=object_size,
        object_height=object_height,
        goal_size=goal_size,
        agent_radius=agent_radius,
        agent_height=agent_height,
        merge_walls=merge_walls,
        size_jitter=size_jitter,
        yaw_jitter=yaw_jitter,
        seed=seed,
        goal_crate=goal_crate,
        drop_targets=drop_targets,
        drop_crates=drop_crates,
    )
    results = convert_all(inputs, conversion, workers)
    if json:
        print_json({"scenes": [{"scene": name, "file": file} for name, file in results]})
    else:
        print_table(["scene", "file"], results)
        print_line(f"{counted(len(results), 'scene')} written to {out}")
    return True


@dataclass(frozen=True)
class Format:
    """A format of scenes: the suffix of its files, and the function that writes one."""

    suffix: str
    write: Callable[[Path, Scene], None] = write_scene


FORMATS = {
    "yaml": Format(".yaml"),
    "g": Format(".g"),
    "mjcf": Format(".xml"),
    "mjcf-mocap": Format(".xml", partial(write_mjcf, movable=Movable.MOCAP)),
}


@dataclass(frozen=True)
class Conversion:
    """What to do with every input.

    Attributes:
        out: Folder of the results.
        format: What their files are.
        settings: Options for levels.
        preset: Geometry preset that scenes are changed to; None keeps their geometry.
        tolerance: Penetration that counts as touching [m]; None keeps that of the preset or scene.
    """

    out: Path
    format: Format
    settings: ConversionSettings
    preset: str | None = None
    tolerance: float | None = None


@dataclass(frozen=True, eq=False)
class _Input:
    """A level, or a scene file, the name of what it becomes, and what messages call it."""

    name: str
    source: Level | Path
    where: str


def conversion_of(out: Path, to: str, preset: str | None, tolerance: float | None, **options: Any) -> Conversion:
    """What the command's options ask for; `options` are fields of `ConversionSettings`.

    Raises:
        InputError: naming the option that is not allowed.
    """
    require_choice("--to", to, list(FORMATS))
    if preset is not None:
        require_choice("--preset", preset, list(PRESETS))
    return Conversion(out, FORMATS[to], ConversionSettings(preset or CLEAR.name, **options), preset, tolerance)


def scene_of(level: Level, settings: ConversionSettings | None = None, tolerance: float | None = None) -> Scene:
    """The scene of a level, called as its file will be.

    Args:
        level: A playable level.
        settings: Options; by default those of `ConversionSettings()`.
        tolerance: Penetration that counts as touching [m]; None takes the preset's.

    Raises:
        InputError: the level cannot be converted.
    """
    scene = convert_level(level, settings)
    return adapted(replace(scene, name=safe_name(level.name)), None, tolerance)


def convert_all(inputs: Sequence[Path], conversion: Conversion, workers: int) -> list[tuple[str, str]]:
    """Writes the scene of every input; names and files.

    Raises:
        InputError: an input cannot be converted, two become one file, or the folder cannot be written.
    """
    found = [(source.name, source.where) for source in _inputs(inputs, conversion)]
    names = [name for name, _ in found]
    require_distinct(names, "inputs", [where for _, where in found])
    require_writable(conversion.out)
    with progress() as bar:
        files = in_order(partial(_convert, conversion), _inputs(inputs, conversion), workers)
        return list(zip(names, bar.track(files, total=len(names), description="scenes"), strict=True))


def _inputs(paths: Sequence[Path], conversion: Conversion) -> Iterator[_Input]:
    """All inputs one by one, each validated when it is reached."""
    files = (file for path in paths for file in ((path,) if is_level_set(path) else expanded([path], SCENE_SUFFIXES)))
    for path in files:
        if is_scene(path):
            _require_options_of_scenes(path, conversion)
            scene = read_scene_file(path, conversion.preset, conversion.tolerance)
            yield _Input(safe_name(scene.name), path, str(path))
        else:
            for level in iter_playable_levels(path):
                yield _Input(safe_name(level.name), level, f"{path}: level {level.name!r}")


def _require_options_of_scenes(path: Path, conversion: Conversion) -> None:
    given = conversion.settings
    if given != ConversionSettings(preset=given.preset):
        raise InputError(str(path), "sizes and choices apply to levels only; a scene takes --preset and --tolerance")


def _convert(conversion: Conversion, given: _Input) -> str:
    """Writes the scene of an input; its file."""
    if isinstance(given.source, Level):
        scene = scene_of(given.source, conversion.settings, conversion.tolerance)
    else:
        scene = read_scene_file(given.source, conversion.preset, conversion.tolerance)
    file = conversion.out / f"{given.name}{conversion.format.suffix}"
    conversion.format.write(file, scene)
    return str(file)
