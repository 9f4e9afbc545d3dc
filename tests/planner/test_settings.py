"""Settings: methods, presets, and what is refused."""

import json
from dataclasses import fields
from typing import Any

import pytest

from pcg.errors import InputError
from planner.settings import METHODS, PRESETS, Settings, settings_for


@pytest.mark.parametrize(
    ("method", "generator", "letters"),
    [("Rnd+FPR", "Rnd", "FPR"), ("Rnd+R", "Rnd", "R"), ("Btl+FPR", "Btl", "FPR"), ("Hum+R", "Hum", "R")],
)
def test_the_name_of_a_method_says_what_it_does(method: str, generator: str, letters: str):
    """Generator before the plus, letters behind it."""
    settings = Settings(method=method)
    assert (settings.generator, settings.letters) == (generator, letters)


def test_all_published_methods_are_there():
    """The methods of the published comparison are allowed."""
    published = {"Rnd+FPR", "Rnd+FP", "Rnd+FR", "Rnd+R", "Btl+FPR", "Hum+R", "MBTS"}
    assert published <= set(METHODS)
    assert [Settings(method=method).method for method in METHODS] == list(METHODS)


@pytest.mark.parametrize("method", ["", "rnd+fpr", "Rnd", "Rnd+RPF", "Foo+R"])
def test_unknown_methods_are_refused(method: str):
    """The message names what was found and what is allowed."""
    with pytest.raises(InputError, match=r"method: found '.*', allowed are Rnd\+FPR, "):
        Settings(method=method)


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan")])
def test_time_limits_are_positive(seconds: float):
    """A limit of nothing is refused."""
    with pytest.raises(InputError, match=r"time limit: found .*, must be a finite number of seconds > 0"):
        Settings(time_limit=seconds)


def test_unknown_motion_planners_are_refused():
    """The message names what was found and what is allowed; by default RRT-Connect plans motions, as published."""
    assert {settings.motion for settings in PRESETS.values()} == {"rrt"}
    with pytest.raises(InputError, match=r"motion: found 'ompl:PRM', allowed are ompl, rrt, visibility, ompl:RRT"):
        Settings(motion="ompl:PRM")


@pytest.mark.parametrize("preset", ["fast", "faithful"])
def test_presets_are_named_after_themselves(preset: str):
    """`settings_for` gives the preset with changes, the others stay."""
    settings = settings_for(preset, method="Rnd+R", time_limit=5.0)
    assert (settings.preset, settings.method, settings.time_limit) == (preset, "Rnd+R", 5.0)
    unchanged = [field.name for field in fields(Settings) if field.name not in {"method", "time_limit"}]
    assert all(getattr(settings, name) == getattr(PRESETS[preset], name) for name in unchanged)


def test_unknown_presets_are_refused():
    """The message names both presets."""
    with pytest.raises(InputError, match="settings: found 'slow', allowed are fast, faithful"):
        settings_for("slow")
    with pytest.raises(InputError, match="method: found"):
        settings_for("fast", method="none")


def test_the_faithful_preset_is_as_published():
    """Two equal configurations by object positions alone, two expansions of one, candidates from the whole room."""
    faithful = PRESETS["faithful"]
    assert (faithful.equal_configurations, faithful.expansions, faithful.near_share) == (2, 2, 0.0)
    assert not faithful.rejection_by_access
    assert faithful.contact_share == 0.0
    assert faithful.restart_after >= faithful.max_expansions
    assert PRESETS["fast"].expansions == 2


def test_the_document_holds_every_field():
    """Plan files record each parameter as a plain value."""
    document = Settings().as_document()
    assert set(document) == {field.name for field in fields(Settings)}
    assert Settings(**json.loads(json.dumps(document))) == Settings()


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"preset": "slow"}, "preset: found 'slow', allowed are fast, faithful"),
        ({"time_limit": float("inf")}, "time limit: found inf, must be a finite number"),
        ({"candidates": 0}, "candidates: found 0, must be at least 1"),
        ({"keep_share": 1.5}, "keep_share: found 1.5, must be > 0 and at most 1"),
        ({"contact_share": -0.1}, "contact_share: found -0.1, must be from 0 to 1"),
        ({"rejection_cell": 0.0}, "rejection_cell: found 0.0, must be > 0"),
        ({"rejection_cell": float("nan")}, "rejection_cell: found nan, must be > 0"),
        ({"shortcut_rounds": -1}, "shortcut_rounds: found -1, must be at least 0"),
        ({"mbts_phase_steps": 0}, "mbts_phase_steps: found 0, must be at least 1"),
        ({"mbts_noise": -0.1}, "mbts_noise: found -0.1, must be at least 0"),
    ],
)
def test_values_that_make_no_sense_are_refused(changes: dict[str, Any], problem: str):
    """Settings name the parameter and what is allowed."""
    with pytest.raises(InputError, match=problem):
        Settings(**changes)


@pytest.mark.parametrize(
    "name", [field.name for field in fields(Settings) if field.type in ("int", "float", int, float)]
)
def test_every_number_has_a_range(name: str):
    """There is no number of which -1 or NaN would make sense, so none goes unchecked."""
    for value in (-1, float("nan")):
        with pytest.raises(InputError, match=f"{name.replace('time_limit', 'time limit')}: found"):
            Settings(**{name: value})
