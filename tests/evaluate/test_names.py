"""Names of files."""

from pathlib import PurePosixPath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evaluate.names import MAX_LENGTH, counting_order, require_distinct, safe_name
from pcg.errors import InputError


@given(st.text())
def test_any_name_becomes_one_visible_component(name: str):
    """Whatever the text, its safe name stays inside its folder, is visible, and is bounded."""
    safe = safe_name(name)
    assert PurePosixPath("folder", safe).parent == PurePosixPath("folder")
    assert not safe.startswith(".")
    assert 0 < len(safe) <= MAX_LENGTH
    assert safe_name(safe) == safe


def test_usual_names_stay_as_they_are():
    """Names of scenes and methods are already safe."""
    assert safe_name("p2-maze-easy-Rnd+FPR-0") == "p2-maze-easy-Rnd+FPR-0"


def test_hostile_names_lose_their_power():
    """Separators, parent folders and blanks do not survive."""
    assert safe_name("../../etc/passwd") == "_.._etc_passwd"
    assert safe_name("a b\n") == "a_b_"
    assert safe_name("..") == "unnamed"


def test_equal_names_are_refused():
    """Names that differ in case only would overwrite each other on some file systems."""
    require_distinct(["a", "b"], "scenes")
    with pytest.raises(InputError, match=r"^scenes: two inputs would be written as 'B'"):
        require_distinct(["a", "b", "B"], "scenes")


def test_numbers_in_names_count():
    """As people count; names that say the same keep an order of their own."""
    names = ["m2-9", "m2-10", "m10-1", "m10-1b", "n", "n01", "n1", "n\u0663", "\xb2"]
    assert sorted(set(names), key=counting_order) == names


@given(st.sets(st.text(max_size=8) | st.from_regex(r"[ab]?[0-9]{1,2}[ab]?", fullmatch=True)))
def test_any_names_have_an_order(names: set[str]):
    """Digits of any script and none, at either end: the order does not depend on where the names come from."""
    assert sorted(names, key=counting_order) == sorted(sorted(names), key=counting_order)
