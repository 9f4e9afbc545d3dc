"""Reading and writing files: clear errors for what cannot be read, no half-written files."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pcg.errors import InputError


def read_text(path: Path) -> str:
    """The text of a UTF-8 file, with line feeds as line endings.

    Raises:
        InputError: the file is missing, is a folder, may not be read or is not UTF-8 text.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(str(path), "no such file") from None
    except UnicodeDecodeError as error:
        raise InputError(str(path), f"not a UTF-8 text file (byte {error.start})") from None
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror}") from None


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yields a temporary path beside `path` (same suffix); on success it replaces `path` in one step.

    Missing folders are made. If the block raises, `path` is left as it was.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem[:100]}-", suffix=path.suffix)
    except OSError as error:
        raise InputError(str(path), f"cannot be written: {error.strerror}") from None
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp makes private files; the result gets the permissions that an ordinary new file would have.
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Writes `text` as UTF-8 in one step: readers see the old file or the new one, never a part."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")
