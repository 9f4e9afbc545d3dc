"""Where compiled code is kept if the usual places cannot be written to."""

import os
import stat
import tempfile
from pathlib import Path
from typing import NoReturn

import pytest

from pcg import compile_cache
from pcg.compile_cache import RECORD, VARIABLE, forget_stale_code, provide_compile_cache


@pytest.fixture(autouse=True)
def unset(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is chosen, and what a test makes the program choose does not outlast it."""
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.delenv(VARIABLE)


@pytest.fixture
def nothing_writable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Only the folder for temporary files can be written to; returns it."""
    monkeypatch.setattr(compile_cache, "_can_write", lambda _: False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_numba_chooses_where_it_can():
    """In a checkout nothing is set: the cache lies beside the source."""
    provide_compile_cache()
    assert VARIABLE not in os.environ


def test_a_chosen_folder_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A folder that the user chose stays, whatever else can be written to."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "chosen"))
    provide_compile_cache()
    assert os.environ[VARIABLE] == str(tmp_path / "chosen")


def test_a_private_folder_takes_their_place(nothing_writable: Path):
    """Where nothing can be written to the cache is temporary, the same one each time, and the user's alone."""
    provide_compile_cache()
    folder = Path(os.environ[VARIABLE])
    assert folder.parent == nothing_writable
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    provide_compile_cache()
    assert os.environ[VARIABLE] == str(folder)


@pytest.mark.usefixtures("nothing_writable")
def test_a_user_may_have_no_home(monkeypatch: pytest.MonkeyPatch):
    """Containers run as users whom the system does not know; without a home the folder is temporary, too."""

    def unknown(user: int) -> NoReturn:
        raise KeyError(user)

    for variable in ("HOME", "XDG_CACHE_HOME"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("pwd.getpwuid", unknown)
    provide_compile_cache()
    assert Path(os.environ[VARIABLE]).is_dir()


@pytest.mark.parametrize("kind", ["open", "link", "file"])
def test_nobody_else_can_prepare_the_folder(nothing_writable: Path, kind: str):
    """A folder that others can write to, a link or a file in its place is not used: the cache is unpickled."""
    expected = nothing_writable / f"manipuzzle-{os.getuid()}"
    if kind == "open":
        expected.mkdir()
        expected.chmod(0o777)
    elif kind == "link":
        expected.symlink_to(nothing_writable)
    else:
        expected.write_text("")
    provide_compile_cache()
    folder = Path(os.environ[VARIABLE])
    assert folder != expected
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


@pytest.mark.parametrize(("name", "writable"), [("", True), ("deep/er", True), ("file", False), ("file/below", False)])
def test_folders_may_have_to_be_made(tmp_path: Path, name: str, *, writable: bool):
    """A folder can be written to if it, or the nearest one above it that exists, can."""
    (tmp_path / "file").write_text("")
    assert compile_cache._can_write(tmp_path / name) is writable  # noqa: SLF001  # replaced in the other tests


def test_compiled_code_goes_when_a_kernel_changes(tmp_path: Path):
    """It stays as long as the kernels do, whatever happens to other modules, and goes as a whole with any of them."""
    (tmp_path / "kernel.py").write_text("from numba import njit")
    (tmp_path / "other.py").write_text("")
    forget_stale_code(tmp_path)
    compiled = [tmp_path / "__pycache__" / name for name in ("kernel.f.nbi", "kernel.f.1.nbc", "caller.g.nbi")]

    def compile_all() -> None:
        for path in compiled:
            path.write_text("")

    compile_all()
    (tmp_path / "other.py").write_text("changed")
    forget_stale_code(tmp_path)
    assert all(path.exists() for path in compiled)
    (tmp_path / "kernel.py").write_text("from numba import njit, prange")
    forget_stale_code(tmp_path)
    assert not any(path.exists() for path in compiled)
    compile_all()
    forget_stale_code(tmp_path)
    assert all(path.exists() for path in compiled)


def test_compiled_code_of_unknown_origin_goes(tmp_path: Path):
    """Without a record nothing says that it is up to date."""
    compiled = tmp_path / "__pycache__" / "kernel.f.nbi"
    compiled.parent.mkdir()
    compiled.write_text("")
    forget_stale_code(tmp_path)
    assert not compiled.exists()
    assert (compiled.parent / RECORD).exists()


def test_stale_code_that_cannot_be_removed_stays(tmp_path: Path):
    """An installation whose cache folder cannot be made or written to is used as it is."""
    (tmp_path / "__pycache__").write_text("no folder")
    forget_stale_code(tmp_path)
    assert (tmp_path / "__pycache__").read_text() == "no folder"
