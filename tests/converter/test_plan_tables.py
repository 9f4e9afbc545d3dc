import csv
from dataclasses import replace
from pathlib import Path

import numpy as np

from converter.formats.plan_tables import csv_text, write_csv, write_npz
from converter.plan import Plan
from converter.scene import Scene
from converter.trajectory import TimedPlan, Trajectory


def trajectory(scene: Scene, plan: Plan) -> Trajectory:
    """A plan in steps of a tenth of a second."""
    return TimedPlan(scene, plan).rows(0.1)


def test_csv_holds_the_trajectory(small_room: Scene, small_plan: Plan):
    """Every number to a nanometre, mode and name of what is held."""
    rows = trajectory(small_room, small_plan)
    read = list(csv.DictReader(csv_text(rows).splitlines()))
    assert list(read[0]) == (
        [
            "t",
            "mode",
            "held",
            "agent_x",
            "agent_y",
            "agent_vx",
            "agent_vy",
            "obj_x",
            "obj_y",
            "obstacle_x",
            "obstacle_y",
        ]
    )
    for columns, values in (
        (["t"], rows.times[:, None]),
        (["agent_x", "agent_y"], rows.agent),
        (["agent_vx", "agent_vy"], rows.velocity),
        (["obj_x", "obj_y", "obstacle_x", "obstacle_y"], rows.objects.reshape(-1, 4)),
    ):
        numbers = [[float(row[column]) for column in columns] for row in read]
        np.testing.assert_allclose(numbers, values, rtol=0, atol=1e-9)
    assert {(row["mode"], row["held"]) for row in read} == {("move", ""), ("carry", "obj")}
    assert [row["held"] for row in read] == ["obj" if held == 0 else "" for held in rows.held]


def test_names_with_commas_and_quotes_survive(small_room: Scene, small_plan: Plan):
    """Names are quoted where the format needs it."""
    odd = replace(trajectory(small_room, small_plan), names=('a,"b"', "c"))
    (first, *_) = csv.reader(csv_text(odd).splitlines())
    assert first[-4:] == ['a,"b"_x', 'a,"b"_y', "c_x", "c_y"]


def test_npz_holds_the_trajectory(tmp_path: Path, small_room: Scene, small_plan: Plan):
    """Arrays bit for bit, read without pickle."""
    rows = trajectory(small_room, small_plan)
    write_npz(tmp_path / "plan.npz", rows)
    with np.load(tmp_path / "plan.npz", allow_pickle=False) as read:
        for name, array in (
            ("t", rows.times),
            ("agent", rows.agent),
            ("velocity", rows.velocity),
            ("objects", rows.objects),
            ("held", rows.held),
            ("segment", rows.segment),
        ):
            np.testing.assert_array_equal(read[name], array)
        assert read["names"].tolist() == ["obj", "obstacle"]
        assert (read["mode"] == np.where(rows.held >= 0, "carry", "move")).all()


def test_files_are_the_same_each_time(tmp_path: Path, small_room: Scene, small_plan: Plan):
    """No dates, no order of chance."""
    for write in (write_csv, write_npz):
        for name in ("a", "b"):
            write(tmp_path / name, trajectory(small_room, small_plan))
        assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
