"""Single settings by name."""

import pytest

from evaluate.setting_values import assignments, changed
from pcg.errors import InputError
from planner import Settings


def test_text_stands_for_values():
    """What a command line gives as text becomes a number, a truth value or text, as the setting wants it."""
    texts = ["candidates=7", "keep_share=0.5", "rejection_by_access=false", "motion=rrt", "demonstrations=a=b"]
    settings = changed(Settings(), assignments(texts, "--set"), "--set")
    assert settings == Settings(
        candidates=7, keep_share=0.5, rejection_by_access=False, motion="rrt", demonstrations="a=b"
    )


@pytest.mark.parametrize("text", ["candidates", "=3", ""])
def test_assignments_need_a_name_and_a_value(text: str):
    """Anything else is refused."""
    with pytest.raises(InputError, match=r"--set: found .*, must be NAME=VALUE"):
        assignments([text], "--set")


def test_a_name_is_given_once():
    """Two values for one setting are a mistake."""
    with pytest.raises(InputError, match="--set: candidates is given twice"):
        assignments(["candidates=1", "candidates=2"], "--set")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("height=3", "--set: no setting 'height', allowed are candidates, "),
        ("method=MBTS", "--set: no setting 'method'"),
        ("candidates=many", "--set: candidates: .*valid integer.* [(]found 'many'[)]"),
        ("candidates=0", "--set: candidates: found 0, must be at least 1"),
        ("near_share=nan", "--set: near_share: must be finite"),
        ("motion=fly", "--set: motion: found 'fly', allowed are"),
    ],
)
def test_bad_values(text: str, message: str):
    """Each is one line that names the setting."""
    with pytest.raises(InputError, match=message):
        changed(Settings(), assignments([text], "--set"), "--set")
