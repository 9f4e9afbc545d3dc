import pytest

from pcg.errors import InputError
from pcg.json_text import parse, require_object


def test_documents_become_plain_values():
    """Text and UTF-8 bytes alike."""
    assert parse('{"a": [1, 2.5, null, true, "é"]}', "file") == {"a": [1, 2.5, None, True, "é"]}
    assert parse('["é"]'.encode(), "file") == ["é"]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "not a JSON document: "),
        ("{", "not a JSON document: .* line 1 column 2"),
        ("1 2", "not a JSON document: Extra data"),
        (b"\xff", "not a JSON document: "),
        ("[" * 200_000, "not a JSON document that can be read: nested too deeply"),
        ("1" * 5_000, "not a JSON document: "),
    ],
)
def test_what_is_no_json_is_named(text: str | bytes, problem: str):
    """Broken, deeply nested and overlong text is one line with the place."""
    with pytest.raises(InputError, match=f"^file: {problem}"):
        parse(text, "file")


def test_an_object_can_be_required():
    """Anything else is named by its kind."""
    assert require_object({"a": 1}, "file") == {"a": 1}
    with pytest.raises(InputError, match=r"^file: a JSON object wanted, found a list$"):
        require_object([], "file")
