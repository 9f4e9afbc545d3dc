from hypothesis import given
from hypothesis import strategies as st

from pcg.printable import MAX_LENGTH, one_line, printable


@given(st.text())
def test_messages_are_one_printable_line(text: str):
    """Whatever a file holds; what can be printed stays as it is, but for its space."""
    line = one_line(text)
    assert line.isprintable()
    if text.isprintable():
        assert line == " ".join(text.split())


def test_what_cannot_be_printed_is_escaped():
    """Control characters, changes of direction and halves of characters can be seen; blanks and letters stay."""
    assert printable("a b\x1b[31m\u202e\ud800é") == r"a b\x1b[31m\u202e\ud800é"


def test_long_messages_lose_their_middle():
    """Both ends are kept, so that place and reason can still be read."""
    assert one_line("a" * MAX_LENGTH) == "a" * MAX_LENGTH
    line = one_line("where: " + "x" * 10 * MAX_LENGTH + " why")
    assert len(line) == MAX_LENGTH
    assert line.startswith("where: x")
    assert line.endswith("x why")
    assert "x…x" in line
    assert one_line("123456789", 6) == "123…89"
