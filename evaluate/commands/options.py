"""What the commands share: how they appear, and arguments and options of several of them."""

from pathlib import Path
from typing import Annotated, Any

import typer


def application(**settings: Any) -> typer.Typer:
    """A Typer application with plain help and without options that install completion."""
    return typer.Typer(add_completion=False, rich_markup_mode=None, **settings)


Json = Annotated[bool, typer.Option("--json", help="Print exactly one JSON document.")]
Out = Annotated[Path, typer.Option(metavar="DIR", help="Folder for the results; made if missing.")]
Seed = Annotated[int, typer.Option(metavar="N", min=0, help="Seed of all random choices.")]
Workers = Annotated[int, typer.Option(metavar="N", min=1, max=1024, help="Processes that share the work.")]

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (.yaml, .g).")]
SceneFiles = Annotated[list[Path], typer.Argument(metavar="SCENE", help="Scene files (.yaml, .g) and folders of them.")]
ObjectName = Annotated[
    str | None, typer.Option("--object", metavar="NAME", help="By default the goal-object.", show_default=False)
]
PLANS_HELP = "Plan files (.json), folders of them, and trials DIR#KEY of studies."
SceneOfPlans = Annotated[
    Path | None,
    typer.Option("--scene", metavar="SCENE", help="Scene of plans whose files hold none.", show_default=False),
]

Preset = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Change the geometry to a preset first: clear or published.", show_default=False),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        metavar="METRES", min=0, help="Penetration that counts as touching, instead of the scene's.", show_default=False
    ),
]

ForwardSearch = Annotated[str, typer.Option(metavar="NAME", help="A method of the forward search.")]
SettingsName = Annotated[str, typer.Option(metavar="NAME", help="Settings of the planner: fast or faithful.")]
Demonstrations = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Demonstrations {scene}.yaml for method Hum+R, instead of data/human.", show_default=False
    ),
]

Still = Annotated[str, typer.Option("--format", metavar="NAME", help="png or svg.")]
Theme = Annotated[str, typer.Option(metavar="NAME", help="Colours: paper or colorblind.")]
