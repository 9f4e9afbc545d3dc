import contextlib
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from converter.formats.rai_text import MAX_FRAMES, Frame, read_frames
from pcg.errors import InputError


def frames(tmp_path: Path, text: str) -> dict[str, Frame]:
    """The frames of a file with this text."""
    path = tmp_path / "scene.g"
    path.write_text(text, encoding="utf-8")
    return read_frames(path)


@pytest.mark.parametrize(
    "text",
    [
        "box (floor) { shape:ssBox, size:[1 2 3 .1], Q:<t(0 0 1)>, flag }",
        "box(floor){shape:ssBox size:[1, 2, 3, .1] Q:<t(0 0 1)> flag}",
        "box (floor) {\n shape=ssBox # remark }\n size=[1 2 3 .1]], Q='t(0 0 1)'; flag }",
        'box\t(floor)\n:{ shape: ssBox size [1. 2. 3. 1e-1] Q = "t(0 0 1)", flag }]',
    ],
)
def test_loose_spellings_mean_the_same(tmp_path: Path, text: str):
    """Separators, `:` or `=`, quotes, comments, line ends and a stray bracket change nothing."""
    frame = frames(tmp_path, text)["box"]
    assert (frame.name, frame.parent) == ("box", "floor")
    assert frame.attributes == {"shape": "ssBox", "size": (1, 2, 3, 0.1), "Q": "t(0 0 1)", "flag": "1"}


def test_places_are_file_and_line(tmp_path: Path):
    """Frames and attributes know where they stand, for later messages."""
    frame = frames(tmp_path, "\n# first\n\na {\n  Q:[0 0 1],\n\n  size:[1 1 1] }")["a"]
    path = tmp_path / "scene.g"
    assert frame.where == f"{path}, line 4"
    assert frame.places == {"Q": f"{path}, line 5", "size": f"{path}, line 7"}


def test_values_may_be_nested(tmp_path: Path):
    """Sets and lists of words are kept as text."""
    attributes = frames(tmp_path, "a { logical:{ object, kind:{ box } } list:[b c], joint:rigid }")["a"].attributes
    assert attributes["logical"] == "{ object kind : { box } }"[2:-2]
    assert attributes["list"] == "b c"
    assert attributes["joint"] == "rigid"


def test_included_frames_come_where_they_are_included(tmp_path: Path):
    """Includes are relative to the file that has them, and keep the order."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "walls.g").write_text("Include '../floor.g'\nwall {}\n")
    (tmp_path / "floor.g").write_text("floor {}\n")
    assert list(frames(tmp_path, "a {}\nInclude: 'parts/walls.g'\nb {}")) == ["a", "floor", "wall", "b"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a {}\na {}", "line 2: frame 'a' was already given"),
        ("\na (b { }", "line 2: 'a': the closing `)` is missing"),
        ("a { Q:[0 0", "line 1: 'Q': the closing `]` is missing"),
        ("\n\na { x:1", "line 3: frame 'a': the closing `}` is missing"),
        ("a { x: }", "line 1: 'x' has no value"),
        ("a\nb {}", "line 1: frame 'a': `{` wanted, found 'b'"),
        ("a { : }", "line 1: a: the name of an attribute wanted, found ':'"),
        ("[1 2]", "line 1: the name of a frame wanted, found '['"),
        ("a { x:'open }", 'line 1: unexpected "\'"'),
        ("Include 'none.g'", "line 1: the included file 'none.g' does not exist"),
        ("\nInclude 'scene.g'", "line 2: 'scene.g' is included twice, or includes itself"),
        ("Include [1 2]", "line 1: Include needs the name of a file"),
        ("Include", "line 1: 'Include' has no value"),
    ],
)
def test_bad_text_is_refused_with_its_line(tmp_path: Path, text: str, message: str):
    """The message names file and line."""
    with pytest.raises(InputError, match=re.escape(f"{tmp_path / 'scene.g'}, {message}")):
        frames(tmp_path, text)


def test_a_circle_of_includes_is_refused(tmp_path: Path):
    """Files that include each other are an error, not an endless loop."""
    (tmp_path / "other.g").write_text("Include 'scene.g'")
    with pytest.raises(InputError, match=re.escape("other.g, line 1: 'scene.g' is included twice")):
        frames(tmp_path, "Include 'other.g'")


def test_the_number_of_frames_is_bounded(tmp_path: Path):
    """A file of a million frames is refused."""
    with pytest.raises(InputError, match="more than 10000 frames"):
        frames(tmp_path, "\n".join(f"f{i} {{}}" for i in range(MAX_FRAMES + 1)))


def test_numbers_are_counted(tmp_path: Path):
    """`numbers` refuses another count, words, and what is not finite."""
    frame = frames(tmp_path, "a { Q:[1 2 3]\n size:[1 inf 2], color:red }")["a"]
    assert frame.numbers("Q", (3, 7)) == (1, 2, 3)
    for key, allowed, message in (
        ("Q", (7,), "line 1: a: Q needs 7 numbers, found '[1 2 3]'"),
        ("size", (3,), "line 2: a: size needs 3 numbers, found '1 inf 2'"),
        ("color", (3, 4), "line 2: a: color needs 3 or 4 numbers, found 'red'"),
        ("X", (3,), "line 1: a: X is missing"),
    ):
        with pytest.raises(InputError, match=re.escape(message)):
            frame.numbers(key, allowed)


@given(text=st.text("ab{}()[]<>:=,'# \n1.-"))
def test_any_text_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str):
    """No text ends in another exception than an input error."""
    with contextlib.suppress(InputError):
        frames(tmp_path_factory.mktemp("any"), text)
