"""`manipuzzle train`: a policy by reinforcement learning."""

from importlib.util import find_spec
from typing import Annotated

import typer

from evaluate.commands.options import Json, Out, Seed, application
from evaluate.inputs import require_choice, require_writable
from evaluate.output import log, print_json, print_line, progress
from pcg.errors import InputError
from pcg.learning_curve import CurveRow
from pcg.representation import REPRESENTATIONS

app = application()

LEARNING = ("torch", "stable_baselines3", "onnx")


@app.command()
def run(
    *,
    representation: Annotated[
        str, typer.Option(metavar="NAME", help="How it edits levels: narrow, turtle, wide or flip.")
    ],
    out: Out,
    steps: Annotated[int, typer.Option(metavar="N", min=1, help="Steps in all; rounded up.")] = 5_000_000,
    seed: Seed = 0,
    rows: Annotated[int, typer.Option(metavar="N", min=2, max=50, help="Inner rows of its levels.")] = 10,
    columns: Annotated[int, typer.Option(metavar="N", min=2, max=50, help="Columns within the outer wall.")] = 10,
    json: Json = False,
) -> bool:
    """Train a policy by PPO on the CPU: {representation}.onnx, curve.png, checkpoints. Needs the extra rl.

    The same command continues an interrupted run, and with more steps a finished one.

    Example:  manipuzzle train --representation narrow --steps 5000000 --seed 0 --out out/narrow
    """
    require_choice("--representation", representation, list(REPRESENTATIONS))
    require_learning()
    from pcg.train import PICTURE_FILE, TrainingSettings, train  # noqa: PLC0415  # torch may be missing

    require_writable(out)
    settings = TrainingSettings.of(representation, rows, columns)
    last: CurveRow | None = None
    with progress("met", "valid") as bar:
        task = bar.add_task("steps", total=steps, met="", valid="")

        def show(row: CurveRow) -> None:
            nonlocal last
            last = row
            bar.update(task, completed=row.steps, met=f"met {row.success:.0%}", valid=f"valid {row.valid:.0%}")

        train(settings, steps, seed, out, progress=show)
    if last is None:
        log(f"{out} holds a run of {steps} steps or more already")
    files = {"policy": str(out / f"{representation}.onnx"), "curve": str(out / PICTURE_FILE)}
    if json:
        print_json({**files, "last": None if last is None else last.model_dump()})
    else:
        print_line(f"policy {files['policy']}, learning curve {files['curve']}")
    return True


def require_learning() -> None:
    """Refuses to train where the extra `rl` is not installed.

    Raises:
        InputError: naming what is missing and how to install it.
    """
    if missing := [name for name in LEARNING if find_spec(name) is None]:
        raise InputError(
            "train",
            f"{', '.join(missing)} not installed; install the extra: pip install 'manipuzzle[rl]', or make setup-rl",
        )
