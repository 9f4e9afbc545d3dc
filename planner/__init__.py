"""From a scene to a plan: forward search over pick-and-place subproblems, and the independent verification.

from planner import Settings, solve
result = solve(scene, Settings(method="Rnd+FPR"), numpy.random.default_rng(0))
"""

from pathlib import Path

from pcg.compile_cache import forget_stale_code
from planner.methods import solve
from planner.result import PlanResult
from planner.settings import METHODS, PRESETS, Settings, settings_for

__all__ = ["METHODS", "PRESETS", "PlanResult", "Settings", "settings_for", "solve"]

forget_stale_code(Path(__file__).parent)
