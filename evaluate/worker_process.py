"""A worker process: started by a coordinator, does the tasks that it is sent, ends with it.

Coordinator and worker hold the two ends of one socket pair. The worker is a fresh interpreter with the coordinator's
module search path, and leads a session of its own: Ctrl-C at a terminal does not reach it, and what it starts can be
found and ended with it.
"""

import contextlib
import json
import os
import resource
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from pcg.printable import one_line

READY = None
"""What a worker sends when it can take its first task; later it sends pairs: whether a task succeeded, and its result
or the reason."""

_START = """
import json, sys
sys.path[:] = json.loads(sys.argv[2])
from evaluate.worker_process import serve
serve(int(sys.argv[1]))
"""
_END_S = 10.0
"""How long a process may take to end after it has closed its connection [s]."""


@dataclass(frozen=True)
class Duty:
    """What a worker does; see `evaluate.workers.Job`."""

    function: Callable[[Any], Any]
    prepare: Callable[[], object] | None
    memory_mb: int | None


@dataclass(frozen=True)
class Unprepared:
    """What a worker sends whose preparation failed, with the reason in one line; then it ends."""

    reason: str


class WorkerProcess:
    """The coordinator's side of a worker process, which starts at once.

    Attributes:
        connection: Leads to the process.
    """

    def __init__(self, duty: Duty) -> None:
        ours, theirs = socket.socketpair()
        arguments = [sys.executable, "-P", "-c", _START, str(theirs.fileno()), json.dumps(sys.path)]
        with theirs:
            # stdout belongs to the results of the command; what libraries print goes to stderr.
            self._process = subprocess.Popen(  # noqa: S603  # our own interpreter with our own module
                arguments,
                stdin=subprocess.DEVNULL,
                stdout=sys.__stderr__,
                pass_fds=[theirs.fileno()],
                start_new_session=True,
            )
        self.connection = Connection(ours.detach())
        # A process that ends at once is noticed by whoever reads from it.
        with contextlib.suppress(OSError):
            self.connection.send(duty)

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def kill(self) -> None:
        """Ends the process and all that it has started."""
        self._process.kill()
        self.ended()

    def ended(self) -> int:
        """The exit code of a process that has closed its connection; minus the signal that killed it.

        What it has started is ended.
        """
        try:
            code = self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            code = self._process.wait()
        kill_session(self.pid)
        self.connection.close()
        return code


def kill_session(leader: int) -> None:
    """Kills the processes of the session that `leader` began, but for itself; where there is no /proc, none."""
    for path in Path("/proc").glob("[0-9]*"):
        pid = int(path.name)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            if pid != leader and os.getsid(pid) == leader:
                os.kill(pid, signal.SIGKILL)


def serve(descriptor: int) -> None:
    """The worker process: does each task that arrives, until the connection closes."""
    connection = Connection(descriptor)
    threading.Thread(target=_end_with_coordinator, args=(descriptor,), daemon=True).start()
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
        duty: Duty = connection.recv()
        if duty.memory_mb is not None:
            resource.setrlimit(resource.RLIMIT_DATA, (duty.memory_mb << 20, duty.memory_mb << 20))
        if duty.prepare is not None:
            prepared, reason = _outcome(lambda prepare: prepare(), duty.prepare)
            if not prepared:
                connection.send(Unprepared(reason))
                return
        connection.send(READY)
        while True:
            connection.send(_outcome(duty.function, connection.recv()))


def _outcome(function: Callable[[Any], Any], task: Any) -> tuple[bool, Any]:
    try:
        return True, function(task)
    except Exception as error:  # noqa: BLE001  # whatever a task raises is its outcome
        return False, one_line(f"{type(error).__name__}: {error}")


def _end_with_coordinator(descriptor: int) -> None:
    """Ends this process and what it has started as soon as the other end of its connection is closed."""
    poller = select.poll()
    # Hanging up is reported without being asked for, and nothing else must be.
    poller.register(descriptor, 0)
    poller.poll()
    if os.getsid(0) == os.getpid():
        kill_session(os.getpid())
    os._exit(1)
