import contextlib
import re
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from pcg import yaml_text
from pcg.errors import InputError

SCALARS = (
    st.none()
    | st.booleans()
    | st.integers(-(10**17), 10**17)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(codec="utf-8", exclude_categories=["C"]))
)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text("abc-1"), inner, max_size=3)
)


@given(st.dictionaries(st.text("xyz", min_size=1), VALUES, max_size=3))
def test_plain_values_survive(document: dict[str, Any]):
    """Whatever is dumped is read back, equal and of the same types; other YAML readers read the same text."""
    text = yaml_text.dump(document)
    assert repr(yaml_text.parse(text, "file")) == repr(document)
    yaml.safe_load(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001),
        ("1.5E2", 150.0),
        (".5", 0.5),
        ("2.", 2.0),
        ("-0.1", -0.1),
        ("010", 10),
        ("on", "on"),
        ("yes", "yes"),
        ("1:30", "1:30"),
        ("2024-01-01", "2024-01-01"),
        ("1_000", "1_000"),
        ("0x10", "0x10"),
        ("true", True),
        ("~", None),
        ("'1e-3'", "1e-3"),
    ],
)
def test_scalars_follow_yaml_1_2(text: str, value: Any):
    """Numbers are what people mean by them, and words stay words."""
    assert repr(yaml_text.parse(f"key: {text}", "file")["key"]) == repr(value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1, 2\nb: 3", "file, line 2: not a YAML file"),
        ("a: 1\nb: 2\na: 3", "file, line 3: not a YAML file: 'a' is given twice"),
        ("a: 1\n1: 2\n'1': 3", "file, line 3: not a YAML file: '1' is given twice"),
        ("? [1, 2]\n: 3", "file, line 1: not a YAML file: a key must be plain text"),
        ("a: 1\nb: &x 2", "file, line 2: anchors and aliases are not allowed"),
        ("a: *x", "file, line 1: anchors and aliases are not allowed"),
        ("a: !!python/object:os.system x", "file, line 1: tags are not allowed"),
        ("a: !!binary aGk=", "file, line 1: tags are not allowed"),
        ("a: 1\n---\nb: 2", "file, line 2: not a YAML file"),
        ("[" * 100_000, "nested deeper than 20 levels"),
        ("- " * 1000, "nested deeper than 20 levels"),
        ("a: \x07", "file: not a YAML file"),
        ("\ta: 1", "file, line 1: not a YAML file"),
    ],
)
def test_bad_text_is_refused_with_its_line(text: str, message: str):
    """One line of message: where, and what is wrong."""
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        yaml_text.parse(text, "file")
    assert "\n" not in str(caught.value)


def test_an_alias_bomb_is_refused():
    """A billion laughs never unfold."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 10)]
    with pytest.raises(InputError, match="anchors and aliases"):
        yaml_text.parse("\n".join(lines), "file")


@given(st.text())
def test_any_text_is_read_or_refused(text: str):
    """No text ends in another exception than an input error."""
    with contextlib.suppress(InputError):
        yaml_text.parse(text, "file")


@given(st.text(st.sampled_from("# $\n\t:-'|\"é"), max_size=12))
def test_text_of_several_lines_survives(text: str):
    """Whatever stands at the ends of its lines, wherever it stands in the document."""
    document = {"a": {"text": text, "list": [text, 1]}, "b": yaml_text.Flow({"text": text})}
    assert yaml_text.parse(yaml_text.dump(document), "file") == document


def test_a_level_is_written_line_by_line():
    """People can see it in the file."""
    assert yaml_text.dump({"xsb": "###\n# #\n"}) == "xsb: |\n  ###\n  # #\n"
