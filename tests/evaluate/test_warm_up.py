"""Warming up before trials."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

SCRIPT = """
import sys
from pathlib import Path

from numba.core.dispatcher import Dispatcher

from converter.formats import read_scene
from evaluate.trial import run_trial, warm_up
from planner import settings_for


def compiled():
    modules = [module for name, module in list(sys.modules.items()) if name.startswith("planner.")]
    found = [value for module in modules for value in vars(module).values() if isinstance(value, Dispatcher)]
    return {f"{function.__name__}{signature}" for function in found for signature in function.signatures}


settings = settings_for("fast", time_limit=60)
warm_up(settings)
before = compiled()
assert run_trial(read_scene(Path("data/puzzles/corner.yaml")), settings, 1).plan.pick_places > 1
print(*sorted(compiled() - before))
"""
"""Prints what a trial with subgoals compiled although it was warmed up."""


def test_nothing_is_left_to_compile():
    """After warming up, a trial that goes over subgoals loads and compiles nothing more, so its time is its own."""
    done = subprocess.run(  # noqa: S603 - our own interpreter with our own script
        [sys.executable, "-c", SCRIPT], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, "\n"), done.stderr
