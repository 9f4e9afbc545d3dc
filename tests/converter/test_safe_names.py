import re

from hypothesis import given
from hypothesis import strategies as st

from converter.formats.safe_names import safe_names


def test_harmless_names_stay():
    """Names that every format can hold are kept."""
    assert safe_names(["obj", "block_2_6", "sub-goal.1"]) == ["obj", "block_2_6", "sub-goal.1"]


def test_what_a_format_cannot_hold_is_replaced():
    """Blanks, markup, other scripts and leading digits."""
    assert safe_names(["a b", "<wall>", "Würfel", "7up", "箱"]) == ["a_b", "n__wall_", "W_rfel", "n_7up", "n__"]


def test_reserved_and_repeated_names_are_numbered():
    """Also where names differ only in case, which some formats ignore."""
    assert safe_names(["world", "Obj", "obj", "OBJ"], ["World"]) == ["world_2", "Obj", "obj_2", "OBJ_3"]


@given(st.lists(st.text(max_size=5)), st.lists(st.text(max_size=3)))
def test_safe_names_are_safe_and_distinct(names: list[str], reserved: list[str]):
    """Whatever the names are, so many distinct ones come out, none reserved."""
    safe = safe_names(names, reserved)
    assert len({name.lower() for name in safe}) == len(names)
    assert all(re.fullmatch(r"[A-Za-z][A-Za-z0-9_.-]*", name) for name in safe)
    assert not {name.lower() for name in safe} & {name.lower() for name in reserved}
