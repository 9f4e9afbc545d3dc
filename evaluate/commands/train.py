"""`manipuzzle train`: a policy by reinforcement learning."""

from importlib.util import find_spec
from pathlib import Path

from evaluate.inputs import require_choice, require_writable
from evaluate.output import log, print_json, print_line, progress
from pcg.errors import InputError
from pcg.learning_curve import CurveRow
from pcg.representation import REPRESENTATIONS

LEARNING = ("torch", "stable_baselines3", "onnx")


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


def run(representation: str, steps: int, seed: int, rows: int, columns: int, out: Path, *, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.train`."""
    require_choice("--representation", representation, list(REPRESENTATIONS))
    require_learning()
    from pcg.episodes import EpisodeSettings  # noqa: PLC0415 - together with torch, below
    from pcg.train import PICTURE_FILE, TrainingSettings, train  # noqa: PLC0415 - torch may be missing

    require_writable(out)
    settings = TrainingSettings(episode=EpisodeSettings(representation, rows, columns))
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
    if as_json:
        print_json({**files, "last": None if last is None else last.model_dump()})
    else:
        print_line(f"policy {files['policy']}, learning curve {files['curve']}")
    return True
