"""Trajectories as tables: CSV for people and spreadsheets, NPZ for programs.

One row a moment; straight lines between rows are the motion. CSV columns: `t` [s], `mode` (`move` or `carry`), `held`
(name of the object or nothing), `agent_x`, `agent_y` [m], `agent_vx`, `agent_vy` [m/s], and `{object}_x`,
`{object}_y` [m] for each object. Mode, object and velocity hold from their row to the next.

Arrays of an NPZ file with n rows and k objects: `t` (n,), `agent` (n, 2), `velocity` (n, 2), `objects` (n, k, 2),
`mode` (n,) text, `held` (n,) index of the object or -1, `segment` (n,) index in the plan, `names` (k,) text.

The same trajectory gives the same file, byte for byte.
"""

import csv
import io
import zipfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

from converter.shape import rounded
from converter.trajectory import NOTHING, Trajectory
from pcg.files import replacing, write_text

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The earliest date that a ZIP archive can hold; a real one would make every file differ."""

_DIGITS = 9


def write_csv(path: Path, trajectory: Trajectory) -> None:
    """Writes a trajectory as comma-separated values, to nanometres.

    Raises:
        InputError: the path cannot be written.
    """
    write_text(path, csv_text(trajectory))


def csv_text(trajectory: Trajectory) -> str:
    """The rows of a trajectory as comma-separated values, the names of the columns first."""
    columns = ["t", "mode", "held", "agent_x", "agent_y", "agent_vx", "agent_vy"]
    columns += [f"{name}_{axis}" for name in trajectory.names for axis in "xy"]
    places = trajectory.objects.reshape(len(trajectory.times), -1)
    motion = rounded(np.column_stack([trajectory.agent, trajectory.velocity, places]), _DIGITS)
    held = [trajectory.names[index] if index != NOTHING else "" for index in trajectory.held]
    times = rounded(trajectory.times, _DIGITS).tolist()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(
        [time, mode, name, *row]
        for time, mode, name, row in zip(times, _modes(trajectory), held, motion.tolist(), strict=True)
    )
    return text.getvalue()


def write_npz(path: Path, trajectory: Trajectory) -> None:
    """Writes a trajectory as NumPy arrays, which `numpy.load` reads without pickle.

    Raises:
        InputError: the path cannot be written.
    """
    arrays: dict[str, npt.NDArray[np.generic]] = {
        "t": trajectory.times,
        "agent": trajectory.agent,
        "velocity": trajectory.velocity,
        "objects": trajectory.objects,
        "mode": np.array(_modes(trajectory)),
        "held": trajectory.held,
        "segment": trajectory.segment,
        "names": np.array(trajectory.names),
    }
    with replacing(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            content = io.BytesIO()
            np.lib.format.write_array(content, array, allow_pickle=False)
            entry = zipfile.ZipInfo(f"{name}.npy", _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content.getvalue())


def _modes(trajectory: Trajectory) -> list[str]:
    return ["move" if index == NOTHING else "carry" for index in trajectory.held]
