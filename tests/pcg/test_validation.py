import pytest
from pydantic import Field

from pcg.errors import InputError
from pcg.validation import Document, validated


class Point(Document):
    """A document with a nested list."""

    name: str
    values: list[float] = Field(default_factory=list)


def test_good_documents_become_models():
    """Fields are taken over, defaults are filled in."""
    assert validated(Point, {"name": "a", "values": [1]}, "file") == Point(name="a", values=[1.0])
    assert validated(Point, {"name": "a"}, "file").values == []


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"values": []}, r"file: name: is missing$"),
        ({"name": "a", "values": [0, "x"]}, r"file: values\[1\]: .*\(found 'x'\)$"),
        ({"name": "a", "values": [float("inf")]}, r"file: values\[0\]: .*\(found inf\)$"),
        ({"name": 1, "more": 2}, r"file: name: .*\(found 1\); 1 more problem$"),
        ([], r"file: document: .*\(found \[\]\)$"),
        ({"name": ["x\n" * 1000]}, r"file: name: [^\n]{,150}$"),
    ],
)
def test_bad_documents_give_one_line(document: object, message: str):
    """The message names the first field, what was found and how many problems are left."""
    with pytest.raises(InputError, match=message):
        validated(Point, document, "file")
