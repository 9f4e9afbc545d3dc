"""Any program as a planner: it reads a scene and writes a plan.

The program is started once per trial, in the folder of the study's file. On stdin it gets one JSON document, the
request:

    {"format": 1, "scene": {...}, "name": "wall", "seed": 0, "time_limit_s": 60.0, "max_expansions": 100000,
     "options": {...}}

`scene` is what a scene file holds (metres, radians, world frame), `options` are those of the study's file. On stdout it
writes one JSON document, the answer:

    {"status": "solved",
     "segments": [{"mode": "move", "path": [[x, y], ...]}, {"mode": "carry", "object": "obj", "path": [[x, y], ...]}],
     "certificate": "...", "counters": {"nodes": 17}}

`segments` are those of a plan file; `status` is one of solved, exhausted, timeout, infeasible, error, and all but
`status` and the segments of a solution may be left out. Arguments of the command may hold `{scene}` (a scene file in
YAML), `{request}` (a file with the request), `{plan}` (a file that the answer is read from instead of stdout), `{seed}`
and `{time_limit}` [s]. Of a program that fails the end of its stderr is quoted.

The time that counts is the wall time of the process, its start included. A program that is not done by the time limit
and a moment more is killed with all that it has started, and the trial is a `timeout`. One that fails, or whose answer
is no such document, makes the trial an `error`; so does one that writes any file of more than 16 MiB. Its plans are
verified like all others.
"""

import contextlib
import json
import math
import os
import resource
import signal
import subprocess
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from converter.formats import scene_yaml
from converter.formats.body_document import Number
from converter.plan import MAX_SEGMENTS, Plan, Segment, Status
from converter.scene import Scene
from evaluate.placements import with_placements
from pcg import json_text
from pcg.errors import InputError
from pcg.validation import Document, PlainText, validated
from planner import Settings

GRACE_S = 0.5
"""How long after its time limit a program may still end by itself [s]: what counts the limit is not always precise."""

MAX_ANSWER_BYTES = 16 << 20
QUOTED_BYTES = 300
"""How much of the end of its stderr is quoted of a program that failed."""


class ProgramError(RuntimeError):
    """A program failed, or did not answer as it should."""


class _Segment(Document):
    mode: Literal["move", "carry"]
    object: PlainText | None = None
    path: list[tuple[Number, Number]]


class _Answer(Document):
    format: Literal[1] = 1
    status: Status
    segments: Annotated[list[_Segment], Field(max_length=MAX_SEGMENTS)] = Field(default_factory=list)
    certificate: PlainText | None = None
    counters: dict[PlainText, float] = Field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Program:
    """A program and its arguments.

    Attributes:
        command: The program and its arguments, with place-holders.
        options: Plain values that the request hands on.
        folder: Where it is started; not part of its identity.
    """

    command: tuple[str, ...]
    options: Mapping[str, Any] = field(default_factory=dict)
    folder: str = "."

    def plan(self, scene: Scene, settings: Settings, seed: int) -> Plan:
        """Runs the program on a scene.

        Raises:
            ProgramError: it cannot be started, fails, or answers something else than a plan.
        """
        with tempfile.TemporaryDirectory(prefix="manipuzzle-") as folder:
            exchange = _Exchange(Path(folder))
            exchange.write(scene, settings, seed, self.options)
            command = [_filled(text, exchange, seed, settings.time_limit) for text in self.command]
            started = time.perf_counter()
            finished = self._run(command, exchange, settings.time_limit + GRACE_S)
            time_s = time.perf_counter() - started
            if not finished:
                return _plan(_Answer(status=Status.TIMEOUT), scene, seed, time_s)
            return _plan(exchange.read(), scene, seed, time_s)

    def document(self) -> dict[str, Any]:
        """See `evaluate.method.Planner`."""
        return {"command": list(self.command), "options": dict(self.options)}

    def suits(self, scene: Scene, settings: Settings) -> bool:
        """Every scene."""
        del scene, settings
        return True

    def prepare(self, scene: Scene, settings: Settings) -> None:
        """Nothing to do: every trial starts a process of its own."""

    def _run(self, command: list[str], exchange: "_Exchange", seconds: float) -> bool:
        """Whether the program ended within the time; whatever it started is dead afterwards."""
        with exchange.request.open("rb") as asked, exchange.stdout.open("wb") as answer, exchange.stderr() as errors:
            try:
                process = subprocess.Popen(  # noqa: S603  # the study's author names the program
                    command, stdin=asked, stdout=answer, stderr=errors, cwd=self.folder, process_group=0
                )
            except OSError as error:
                raise ProgramError(f"{command[0]} cannot be started: {error.strerror}") from None
            try:
                _limit_resources(process, seconds)
                status = process.wait(seconds)
            except subprocess.TimeoutExpired:
                return False
            finally:
                _kill_group(process)
            if status != 0:
                raise ProgramError(f"{Path(command[0]).name} ended with {_ending(status)}{_quoted(errors)}")
            return True


@dataclass(frozen=True)
class _Exchange:
    """The files through which a program and its caller talk."""

    folder: Path

    @property
    def request(self) -> Path:
        return self.folder / "request.json"

    @property
    def scene(self) -> Path:
        return self.folder / "scene.yaml"

    @property
    def plan(self) -> Path:
        return self.folder / "plan.json"

    @property
    def stdout(self) -> Path:
        return self.folder / "stdout"

    def stderr(self) -> IO[bytes]:
        return (self.folder / "stderr").open("w+b")

    def write(self, scene: Scene, settings: Settings, seed: int, options: Mapping[str, Any]) -> None:
        request = {
            "format": 1,
            "scene": scene_yaml.to_document(scene),
            "name": scene.name,
            "seed": seed,
            "time_limit_s": settings.time_limit,
            "max_expansions": settings.max_expansions,
            "options": dict(options),
        }
        self.request.write_text(json.dumps(request), encoding="utf-8")
        scene_yaml.write_scene_yaml(self.scene, scene)

    def read(self) -> _Answer:
        """The answer: from the plan file if there is one, else from stdout."""
        path, where = (self.plan, "{plan}") if self.plan.is_file() else (self.stdout, "stdout")
        if path.stat().st_size > MAX_ANSWER_BYTES:
            raise ProgramError(f"{where}: larger than {MAX_ANSWER_BYTES >> 20} MiB")
        try:
            return validated(_Answer, json_text.parse(path.read_bytes(), where), where)
        except InputError as error:
            raise ProgramError(str(error)) from None


def _plan(answer: _Answer, scene: Scene, seed: int, time_s: float) -> Plan:
    solved = answer.status is Status.SOLVED
    try:
        segments = [Segment(s.mode, s.object, np.array(s.path).reshape(-1, 2)) for s in answer.segments]
        plan = Plan(
            scene=scene.name,
            scene_hash=scene.geometry_hash,
            method="program",
            seed=seed,
            status=answer.status,
            time_s=time_s,
            tolerance=scene.tolerance,
            preset=scene.preset,
            certificate=answer.certificate,
            counters=answer.counters,
            segments=tuple(segments) if solved else (),
            scene_data=scene,
        )
    except ValueError as error:
        raise ProgramError(f"not a plan: {error}") from None
    return with_placements(plan)


def _filled(text: str, exchange: _Exchange, seed: int, time_limit: float) -> str:
    values = {
        "{scene}": str(exchange.scene),
        "{request}": str(exchange.request),
        "{plan}": str(exchange.plan),
        "{seed}": str(seed),
        "{time_limit}": f"{time_limit:g}",
    }
    for place_holder, value in values.items():
        text = text.replace(place_holder, value)
    return text


def _limit_resources(process: "subprocess.Popen[bytes]", seconds: float) -> None:
    """Bounds what a runaway program costs: the size of its files, and its time if nobody is left to kill it."""
    if not hasattr(resource, "prlimit"):
        return
    cpu_s = math.ceil(seconds * (os.cpu_count() or 1)) + 1
    # A program that has ended already needs no limits.
    with contextlib.suppress(ProcessLookupError):
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (MAX_ANSWER_BYTES + 1, MAX_ANSWER_BYTES + 1))
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (cpu_s, cpu_s))


def _kill_group(process: "subprocess.Popen[bytes]") -> None:
    """Ends the program and all that it has started in its process group."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _ending(status: int) -> str:
    return f"signal {-status}" if status < 0 else f"exit status {status}"


def _quoted(errors: IO[bytes]) -> str:
    end = errors.seek(0, os.SEEK_END)
    errors.seek(max(0, end - QUOTED_BYTES))
    text = " ".join(errors.read().decode(errors="replace").split())
    return f": {text}" if text else ""
