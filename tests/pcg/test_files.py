"""Files: read with clear errors, replaced in one step."""

import errno
import os
import stat
from pathlib import Path

import pytest

from pcg.errors import InputError
from pcg.files import iter_lines, read_bytes, read_text, replacing, write_text


def test_text_is_read_as_utf_8_with_line_feeds(tmp_path: Path):
    """A byte order mark and the line ends of other systems do not show."""
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfone\r\ntwo\rthr\xc3\xa9e\n")
    assert read_text(path) == "one\ntwo\nthrée\n"


def test_lines_are_numbered_from_1(tmp_path: Path):
    """The same bytes line by line; the last line needs no end."""
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfone\r\n\ntwo")
    assert list(iter_lines(path)) == [(1, "one"), (2, ""), (3, "two")]


def test_what_cannot_be_read_is_named(tmp_path: Path):
    """A missing file, a folder, a file that is too large, and bytes that are no text."""
    path = tmp_path / "a.txt"
    path.write_bytes(b"12345\xff")
    with pytest.raises(InputError, match=r"b\.txt: no such file"):
        read_bytes(tmp_path / "b.txt")
    with pytest.raises(InputError, match=f"^{tmp_path}: cannot be read: "):
        read_text(tmp_path)
    with pytest.raises(InputError, match="larger than 5e-06 MB"):
        read_bytes(path, 5)
    with pytest.raises(InputError, match=r"not a UTF-8 text file \(byte 5\)"):
        read_text(path)
    with pytest.raises(InputError, match=r"a\.txt: line 1: not UTF-8 text \(byte 5\)"):
        list(iter_lines(path))


def test_a_file_is_replaced_in_one_step(tmp_path: Path):
    """Until the block ends the old file is there; folders are made, and nothing else is left behind."""
    path = tmp_path / "new" / "a.txt"
    write_text(path, "old\n")
    with replacing(path) as temporary:
        temporary.write_text("new\n")
        assert temporary.suffix == ".txt"
        assert path.read_text() == "old\n"
    assert path.read_text() == "new\n"
    assert [file.name for file in path.parent.iterdir()] == ["a.txt"]
    assert stat.S_IMODE(path.stat().st_mode) & 0o400


def write_half(path: Path) -> None:
    """Fails after it has written something."""
    with replacing(path) as temporary:
        temporary.write_text("half")
        raise RuntimeError("in between")


def test_a_failure_leaves_the_old_file(tmp_path: Path):
    """Whatever the block raises is raised, and no temporary file stays."""
    path = tmp_path / "a.txt"
    write_text(path, "old\n")
    with pytest.raises(RuntimeError, match="in between"):
        write_half(path)
    assert path.read_text() == "old\n"
    assert [file.name for file in tmp_path.iterdir()] == ["a.txt"]


def test_what_cannot_be_written_is_named(tmp_path: Path):
    """A file in place of a folder, and a folder in place of the file; no temporary file is named or stays."""
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"a\.txt: cannot be written: "):
        write_text(tmp_path / "file" / "a.txt", "text")
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(InputError, match=f"^{tmp_path}/a\\.txt: cannot be written: "):
        write_text(tmp_path / "a.txt", "text")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.txt", "file"]


def test_a_full_disk_is_said_of_the_file(tmp_path: Path):
    """The system's error names none; other errors of a block are left as they are."""
    with (
        pytest.raises(InputError, match=r"a[.]txt: cannot be written: No space left on device"),
        replacing(tmp_path / "a.txt"),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    with pytest.raises(PermissionError), replacing(tmp_path / "a.txt"):
        raise PermissionError
    assert not list(tmp_path.iterdir())


def test_named_pipes_are_not_waited_for(tmp_path: Path):
    """Those of a shell have no name in the end, and are read."""
    os.mkfifo(tmp_path / "a.txt")
    with pytest.raises(InputError, match=r"a[.]txt: cannot be read: a named pipe"):
        read_text(tmp_path / "a.txt")
    reading, writing = os.pipe()
    os.write(writing, b"text")
    os.close(writing)
    assert read_text(Path(f"/dev/fd/{reading}")) == "text"
    os.close(reading)
