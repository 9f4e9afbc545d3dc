"""Programs as planners."""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from converter.plan import Status
from converter.scene import Scene
from evaluate.method import Method
from evaluate.program import Program, ProgramError
from evaluate.trial import Trial, TrialOutcome, run_trial
from planner import Settings
from planner.verify import ViolationKind

Run = Callable[..., TrialOutcome]


@pytest.fixture
def run(small_room: Scene, tmp_path: Path) -> Run:
    """Plans for the small room by a program that is given as Python text."""

    def runner(text: str, *arguments: str, time_limit: float = 20.0, **options: object) -> TrialOutcome:
        (tmp_path / "program.py").write_text(f"import json, sys, time\n{text}")
        program = Program((sys.executable, "-I", "program.py", *arguments), options, str(tmp_path))
        return Trial(small_room, Method("theirs", Settings(time_limit=time_limit), program), 7).run()

    return runner


def test_a_good_plan_is_verified_like_ours(run: Run, small_room: Scene):
    """Segments on stdout become a plan in the method's name; placements are worked out, the time is measured."""
    ours = run_trial(small_room, Settings(method="Rnd+R"), 0).plan
    segments = [{"mode": s.mode, "object": s.object, "path": s.path.tolist()} for s in ours.segments]
    outcome = run(f"print(json.dumps({{'status': 'solved', 'segments': {segments}, 'counters': {{'nodes': 3}}}}))")
    assert outcome.solved
    plan = outcome.plan
    assert (plan.method, plan.seed, plan.counters, plan.path_length) == ("theirs", 7, {"nodes": 3.0}, ours.path_length)
    assert [(s.object, s.position.tolist()) for s in plan.subgoals] == [
        (s.object, pytest.approx(s.position.tolist())) for s in ours.subgoals
    ]
    assert plan.time_s > 0
    assert plan.settings["command"][1:] == ["-I", "program.py"]


def test_a_bad_plan_is_found_out(run: Run, small_room: Scene):
    """A plan that jumps to the goal is no solution, whatever its program says; nor one with an unknown object."""
    path = [small_room.agent.position.tolist(), small_room.goal.position.tolist()]
    carry = {"mode": "carry", "object": "obj", "path": path}
    outcome = run(f"print(json.dumps({{'status': 'solved', 'segments': [{carry}]}}))")
    assert outcome.verified is False
    unknown = run(f"print(json.dumps({{'status': 'solved', 'segments': [{carry | {'object': 'x'}}]}}))")
    assert unknown.violations is not None
    assert [violation.kind for violation in unknown.violations] == [ViolationKind.UNKNOWN_OBJECT]


def test_the_request_says_everything(run: Run, small_room: Scene, tmp_path: Path):
    """Scene, seed, limits and options arrive on stdin and as a file; the scene is a scene file too."""
    text = f"""
request = json.load(sys.stdin)
assert request == json.load(open(sys.argv[1]))
scene = open(sys.argv[2]).read()
json.dump([request, scene, sys.argv[3:]], open({str(tmp_path / "seen")!r}, "w"))
json.dump({{"status": "exhausted", "certificate": "tried all"}}, open(sys.argv[5], "w"))
print("chatter")
"""
    plan = run(text, "{request}", "{scene}", "{seed}", "{time_limit}", "{plan}", time_limit=8.5, depth=3).plan
    assert (plan.status, plan.certificate, plan.solved) == (Status.EXHAUSTED, "tried all", False)
    request, scene, (seed, time_limit, _) = json.loads((tmp_path / "seen").read_text())
    assert {key: request[key] for key in ("name", "seed", "time_limit_s", "options")} == {
        "name": "small-room",
        "seed": 7,
        "time_limit_s": 8.5,
        "options": {"depth": 3},
    }
    assert [body["name"] for body in request["scene"]["objects"]] == small_room.object_names
    assert "small-room" in scene
    assert (seed, time_limit) == ("7", "8.5")


def test_a_program_that_overruns_is_a_timeout(run: Run, tmp_path: Path):
    """It is killed soon after its limit, with what it has started."""
    text = f"""
import subprocess
child = subprocess.Popen(["/bin/sleep", "600"])
open({str(tmp_path / "pid")!r}, "w").write(str(child.pid))
time.sleep(600)
"""
    outcome = run(text, time_limit=1.0)
    assert outcome.plan.status is Status.TIMEOUT
    assert outcome.verified is None
    child = Path("/proc") / (tmp_path / "pid").read_text() / "stat"
    deadline = time.monotonic() + 20
    while child.exists() and child.read_text().split()[2] != "Z" and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not child.exists() or child.read_text().split()[2] == "Z"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sys.exit('no licence')", r"ended with exit status 1: no licence"),
        ("import os; os.abort()", "ended with signal 6"),
        ("print('solved!')", "stdout: not a JSON document: "),
        ("print('[' * 100000)", "stdout: not a JSON document"),
        ("pass", "stdout: not a JSON document: "),
        ("print('[]')", "stdout: document: "),
        ('print(\'{"status": "won"}\')', "stdout: status: Input should be 'solved'"),
        ('print(\'{"status": "solved", "segments": [{}]}\')', r"stdout: segments\[0\].mode: is missing"),
        (
            'print(\'{"status": "solved", "segments": [{"mode": "move", "path": [[0, NaN]]}]}\')',
            r"stdout: segments\[0\].path\[0\]\[1\]: .*finite",
        ),
        (
            'print(\'{"status": "solved", "segments": [{"mode": "carry", "path": [[0, 0]]}]}\')',
            "not a plan: a carry segment needs an object",
        ),
        ("while True: print('x' * 1000000)", "ended with (signal|exit status)|larger than 16 MiB"),
    ],
)
def test_misbehaviour_is_an_error(run: Run, text: str, message: str):
    """Whatever a program does instead of answering is one line that says so."""
    with pytest.raises(ProgramError, match=message):
        run(text)


def test_a_missing_program_is_an_error(small_room: Scene, tmp_path: Path):
    """The line names the program."""
    program = Program(("./missing",), folder=str(tmp_path))
    with pytest.raises(ProgramError, match=r"\./missing cannot be started: No such file"):
        program.plan(small_room, Settings(), 0)
