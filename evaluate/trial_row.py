"""A trial as a row of a study's database, whatever became of it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TrialRow:
    """One row; the fields are the columns.

    Attributes:
        key: `Trial.key`.
        scene: Name of the scene.
        scene_hash: `Scene.geometry_hash`.
        method: Name of the method in the study.
        seed: Seed of the trial.
        settings: Every setting, JSON; for other people's planners also which one it is.
        settings_hash: `evaluate.method.Method.hash`.
        status: A `converter.plan.Status`.
        verified: Whether the plan passed verification; None without a plan.
        time_s: Planning time; for a trial that was stopped, its wall time [s].
        path_length_m: Distance that the agent drives [m]; None without a plan.
        pick_places: How often an object is picked and placed; None without a plan.
        counters: Work done, JSON.
        message: The certificate of the planner, the first violation, or the reason of a failure.
        plan: The plan file's JSON, compressed by zlib; None without a plan.
        versions: Of manipuzzle and the libraries that it plans with, JSON.
        machine: Processor and system.
        started: ISO 8601, UTC.
        finished: ISO 8601, UTC.
        preset: Geometry preset of the scene; None for other geometry.
    """

    key: str
    scene: str
    scene_hash: str
    method: str
    seed: int
    settings: str
    settings_hash: str
    status: str
    verified: bool | None
    time_s: float
    path_length_m: float | None
    pick_places: int | None
    counters: str
    message: str | None
    plan: bytes | None
    versions: str
    machine: str
    started: str
    finished: str
    preset: str | None = None
