"""Learning curves: the rows that a training run leaves, and their picture."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from pcg.errors import InputError
from pcg.files import read_text, replacing
from pcg.validation import Document


class CurveRow(Document):
    """Means over the episodes that ended between two updates.

    Attributes:
        steps: Steps of the environment so far.
        cpu_s: Processor time so far [s].
        episodes: Episodes that ended.
        success: Share in which everything asked for was met.
        valid: Share that ended with a solvable level.
        pushes: Optimal pushes of the solvable levels.
        occluded: Share of the solvable levels whose goal crate is hidden.
        dependency: Share of the solvable levels in which another crate has to move first.
        gained: Sum of rewards.
        length: Steps of an episode.
    """

    steps: int
    cpu_s: float
    episodes: int = 0
    success: float
    valid: float
    pushes: float
    occluded: float
    dependency: float
    gained: float
    length: float


def read_curve(path: Path) -> list[CurveRow]:
    """The rows of a run, none if the file is missing.

    Raises:
        InputError: the file cannot be read or a line is not a row.
    """
    if not path.exists():
        return []
    lines = read_text(path).split("\n")
    rows = []
    for number, line in enumerate(lines, start=1):
        # A last line without its end was being written when the run was stopped.
        if not line.strip() or number == len(lines):
            continue
        try:
            rows.append(CurveRow.model_validate_json(line))
        except ValueError:
            raise InputError(f"{path}: line {number}", "not a row of a learning curve") from None
    return rows


def smoothed(values: Sequence[float], window: int) -> list[float]:
    """The mean of each value and up to `window` - 1 before it."""
    parts = (values[max(0, i + 1 - window) : i + 1] for i in range(len(values)))
    return [sum(part) / len(part) for part in parts]


def draw_curves(path: Path, runs: Mapping[str, Sequence[CurveRow]], window: int = 10) -> None:
    """Draws success, valid levels and their pushes over the steps, one line a run, smoothed over `window` updates.

    Args:
        path: A PNG or SVG file.
        runs: Rows by the name of the run.
        window: Updates in a moving mean.

    Raises:
        InputError: the file cannot be written.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415  # loaded when something is drawn

    figure = Figure(figsize=(10, 3.2), layout="constrained", dpi=120)
    panels = (("requests met", "success"), ("solvable levels", "valid"), ("optimal pushes", "pushes"))
    for axes, (title, name) in zip(figure.subplots(1, len(panels)), panels, strict=True):
        for label, rows in runs.items():
            values = smoothed([getattr(row, name) for row in rows], window)
            axes.plot([row.steps / 1e6 for row in rows], values, label=label, linewidth=1.4)
        axes.set_title(title)
        axes.set_xlabel("steps [million]")
        axes.set_ylim(bottom=0)
        axes.grid(visible=True, alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    with replacing(path) as temporary:
        figure.savefig(temporary)
