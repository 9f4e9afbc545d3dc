"""Reading and writing files: clear errors for what cannot be read, no half-written files."""

import contextlib
import errno
import itertools
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pcg.errors import InputError

MAX_BYTES = 20_000_000
"""Of a file, unless its reader says otherwise."""

_NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}
"""What a full or broken disk says, without saying of which file."""

MAX_LINES, MAX_LINE_BYTES = 1_000_000, 1_000_000
"""Lines, and bytes of a line, where lines are read one by one."""


def read_bytes(path: Path, max_bytes: int = MAX_BYTES) -> bytes:
    """What a file holds.

    No more than that is ever read, so a shell's pipes and devices may be read too.

    Raises:
        InputError: the file is missing, is a folder, may not be read or is larger.
    """
    with _reading(path), path.open("rb") as file:
        data = file.read(max_bytes + 1)
    if len(data) > max_bytes:
        raise InputError(str(path), f"larger than {max_bytes / 1e6:g} MB, the most that is read")
    return data


def read_text(path: Path, max_bytes: int = MAX_BYTES) -> str:
    """The text of a UTF-8 file, with line feeds as line endings.

    Raises:
        InputError: the file is missing, is a folder, may not be read, is larger or is not UTF-8 text.
    """
    data = read_bytes(path, max_bytes)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(str(path), f"not a UTF-8 text file (byte {error.start})") from None
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def iter_lines(path: Path) -> Iterator[tuple[int, str]]:
    """The lines of a UTF-8 file one by one, without their ends, and their numbers from 1.

    Raises:
        InputError: as `read_text`, or there are more lines or longer ones; when that line is reached.
    """
    with _reading(path), path.open("rb") as file:
        for number in itertools.count(1):
            data = file.readline(MAX_LINE_BYTES + 1)
            if not data:
                return
            if number > MAX_LINES:
                raise InputError(str(path), f"more than {MAX_LINES} lines, the most that are read")
            yield number, _line(data, f"{path}: line {number}", "utf-8-sig" if number == 1 else "utf-8")


def is_file(path: Path) -> bool:
    """Whether there is such a file; False too for paths that the file system cannot have."""
    try:
        return path.is_file()
    except OSError:
        return False


def _line(data: bytes, where: str, encoding: str) -> str:
    if len(data) > MAX_LINE_BYTES:
        raise InputError(where, f"longer than {MAX_LINE_BYTES / 1e6:g} MB, the most that a line may have")
    try:
        return data.decode(encoding).rstrip("\r\n")
    except UnicodeDecodeError as error:
        raise InputError(where, f"not UTF-8 text (byte {error.start})") from None


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    try:
        # Opening it would wait for ever for somebody who writes; pipes of a shell have no path in the end.
        if Path(os.path.realpath(path)).is_fifo():
            raise InputError(str(path), "cannot be read: a named pipe")
        yield
    except FileNotFoundError:
        raise InputError(str(path), "no such file") from None
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror}") from None
    except ValueError as error:
        # A path with a NUL; everything else that is read has its own message.
        if isinstance(error, InputError):
            raise
        raise InputError(str(path), f"cannot be read: {error}") from None


@contextlib.contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Says of which file a step of writing fails, not of which temporary one."""
    try:
        yield
    except (OSError, ValueError) as error:
        problem = error.strerror if isinstance(error, OSError) else error
        raise InputError(str(path), f"cannot be written: {problem}") from None


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yields a temporary path beside `path` (same suffix); on success it replaces `path` in one step.

    Missing folders are made. If the block raises, `path` is left as it was.

    Raises:
        InputError: the folder cannot be made or written to, `path` is a folder, or the disk is full.
    """
    with _writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem[:100]}-", suffix=path.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp makes private files; the result gets the permissions that an ordinary new file would have.
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        with _writing(path):
            temporary.replace(path)
    except OSError as error:
        if error.errno not in _NO_ROOM:
            raise
        raise InputError(str(path), f"cannot be written: {error.strerror}") from None
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Writes `text` as UTF-8 in one step: readers see the old file or the new one, never a part."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")
