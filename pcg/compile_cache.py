"""What Numba keeps of compiled code: where, and when it is stale.

Numba keeps what it has compiled beside the source or else in the user's cache folder, and where it can write to neither
(a read-only image run by a user without a home) it refuses to compile at all. There a private folder for temporary
files takes their place. `NUMBA_CACHE_DIR` chooses another one.

Numba compiles anew what has changed, but not what calls it from another module and holds the old code inside. So where
sources are updated in place, as in a checkout, all of a package's compiled code goes once one of its kernels changes.
"""

import contextlib
import hashlib
import os
import stat
import tempfile
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"

RECORD = "kernels.sha256"
"""File beside the compiled code with the hash of the sources that it comes from."""


def provide_compile_cache() -> None:
    """Sets `NUMBA_CACHE_DIR` if Numba would find no folder to write to; to be called before Numba is imported."""
    chosen = [Path(os.environ[VARIABLE])] if os.environ.get(VARIABLE) else []
    if not any(_can_write(folder) for folder in (*chosen, Path(__file__).parent / "__pycache__", *_user_caches())):
        os.environ[VARIABLE] = str(_private_folder())


def forget_stale_code(package: Path) -> None:
    """Removes the compiled code beside the sources in the folder `package` unless it comes from them as they are."""
    sources = [path.read_bytes() for path in sorted(package.glob("*.py"))]
    digest = hashlib.sha256(b"".join(source for source in sources if b"njit" in source)).hexdigest()
    folder = package / "__pycache__"
    record = folder / RECORD
    # What cannot be written to is not updated in place either.
    with contextlib.suppress(OSError):
        if record.exists() and record.read_text(encoding="ascii") == digest:
            return
        folder.mkdir(exist_ok=True)
        for path in [*folder.glob("*.nbi"), *folder.glob("*.nbc")]:
            path.unlink(missing_ok=True)
        record.write_text(digest, encoding="ascii")


def _user_caches() -> list[Path]:
    """The user's folder for caches; none for a user without a home."""
    if os.environ.get("XDG_CACHE_HOME"):
        return [Path(os.environ["XDG_CACHE_HOME"])]
    try:
        return [Path("~/.cache").expanduser()]
    except RuntimeError:
        return []


def _can_write(folder: Path) -> bool:
    """Whether files can be made in `folder`, which may have to be made first."""
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)


def _private_folder() -> Path:
    """A folder that nobody else can write to: compiled code is loaded by unpickling."""
    folder = Path(tempfile.gettempdir()) / f"manipuzzle-{os.getuid()}"
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077:
        return folder
    return Path(tempfile.mkdtemp(prefix="manipuzzle-"))
