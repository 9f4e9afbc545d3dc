"""Whatever is in a file: a scene, or one line that names the file and a place in it."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from converter.formats import read_scene
from converter.formats.rai_g_export import rai_g_text
from converter.plan import read_plan
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part
from pcg.errors import InputError

DATA = Path(__file__).parents[2] / "data" / "puzzles"
GOLDEN = Path(__file__).parents[1] / "golden"
TRIANGLE = Part(np.array([[-0.2, 0.0], [0.2, 0.0], [0.0, 0.3]]), 0.05)
SCENE = Scene(
    name="tiny",
    bounds=np.array([[-1.0, -1.0], [1.0, 1.0]]),
    tolerance=0.0,
    agent=Agent(np.zeros(2), 0.2),
    walls=(Body("wall", np.array([-0.5, 0.5, 0.25]), 0.5, (TRIANGLE,), 0.4),),
    objects=(Body("obj", np.array([0.5, 0.5, 0.1]), 0.2, (Part.box((0.2, 0.2), 0.02),)),),
    goal=Goal("obj", np.zeros(2), np.ones(2)),
)
TEXTS = {
    ".g": rai_g_text(SCENE),
    ".yaml": (DATA / "wall-easy.yaml").read_text(),
    ".json": (GOLDEN / "maze-clear-plan.json").read_text()[:4000],
}
PIECES = [
    "",
    "{",
    "}",
    "[",
    "]",
    "(",
    ")",
    ":",
    ",",
    "#",
    "'",
    "<",
    ">",
    "-",
    "1e999",
    "nan",
    "0",
    "-1",
    "null",
    "\n",
    "obj",
]
# A place where the text is changed (as a share of it), how much of it goes, and what comes instead.
CHANGES = st.lists(
    st.tuples(st.floats(0, 1), st.integers(0, 12), st.sampled_from(PIECES) | st.text(max_size=3)),
    min_size=1,
    max_size=3,
)


def damaged(text: str, changes: list[tuple[float, int, str]]) -> str:
    """A text with some characters replaced."""
    for share, gone, new in changes:
        at = int(share * len(text))
        text = text[:at] + new + text[at + gone :]
    return text


def refusal(path: Path) -> str | None:
    """Why a file cannot be read; None if it can."""
    try:
        read_plan(path) if path.suffix == ".json" else read_scene(path)
    except InputError as error:
        return str(error)
    return None


@pytest.mark.parametrize("suffix", TEXTS)
@settings(max_examples=100, suppress_health_check=[HealthCheck.too_slow])
@given(changes=CHANGES)
def test_damaged_files_are_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, changes: list[tuple[float, int, str]]
):
    """No other exception, and the message says where."""
    path = tmp_path_factory.getbasetemp() / f"damaged{suffix}"
    path.write_text(damaged(TEXTS[suffix], changes), encoding="utf-8", errors="surrogatepass")
    message = refusal(path)
    if message is not None:
        place, _, problem = message.removeprefix(str(path)).partition(": ")
        assert message.startswith(str(path))
        assert "\n" not in message
        assert re.fullmatch(r"(, line \d+)?", place)
        assert problem


def test_a_damaged_field_of_a_plan_is_named(tmp_path: Path):
    """With its index."""
    document = json.loads((GOLDEN / "maze-clear-plan.json").read_text())
    document["segments"][2]["path"][0][1] = "north"
    (tmp_path / "plan.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"plan\.json: segments\[2\]\.path\[0\]\[1\]: .*found 'north'"):
        read_plan(tmp_path / "plan.json")
