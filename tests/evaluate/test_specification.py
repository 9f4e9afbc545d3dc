"""The file of a study."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from converter.formats import write_scene
from converter.scene import Scene
from evaluate.specification import read_study
from pcg.errors import InputError
from planner import Settings

SPEC = """
name: test
scenes: [scenes/*.yaml]
methods: [Rnd+FPR, Rnd+R]
seeds: 2
"""
LEVELS = """; one
#########
#       #
# @ $ . #
#   $   #
#       #
#########

; two
#########
#       #
# @#$ . #
#   $   #
#       #
#########
"""
AT_THE_BORDER = """
; three
#######
#@ $ .#
#  $  #
#######
"""
MODULE = """
from converter.plan import Status
from planner import PlanResult

def solve(scene, settings, rng, depth=1):
    return PlanResult(Status.EXHAUSTED, 0.0)

number = 3
"""


@pytest.fixture
def spec(tmp_path: Path, small_room: Scene) -> Path:
    """A specification with two scenes and two levels beside it."""
    for name in ("one", "two"):
        write_scene(tmp_path / "scenes" / f"{name}.yaml", replace(small_room, name=name))
    (tmp_path / "levels.xsb").write_text(LEVELS)
    (tmp_path / "their_module.py").write_text(MODULE)
    path = tmp_path / "spec.yaml"
    path.write_text(SPEC)
    return path


def test_a_specification_becomes_a_study(spec: Path):
    """Scenes are found beside the file, a number of seeds counts from 0, and defaults are those of `solve`."""
    study = read_study(spec)
    assert [scene.name for scene in study.scenes] == ["one", "two"]
    assert [method.name for method in study.methods] == ["Rnd+FPR", "Rnd+R"]
    assert [method.settings for method in study.methods] == [Settings(), Settings(method="Rnd+R")]
    assert study.seeds == (0, 1)
    assert study.size == len(list(study.trials())) == 8


def test_limits_and_settings_are_shared(spec: Path):
    """Limits, improvement and demonstrations reach every method; a method's own settings come last."""
    more = "time_limit: 10\nimprove: 5\niterations: 77\ndemonstrations: human\nsettings: faithful\n"
    methods = "methods: [Rnd+R, {method: Rnd+FPR, name: mine, settings: fast, set: {time_limit: 3, motion: rrt}}]"
    spec.write_text(SPEC.replace("methods: [Rnd+FPR, Rnd+R]", methods) + more)
    first, second = (method.settings for method in read_study(spec).methods)
    assert (first.preset, first.time_limit, first.improve, first.max_expansions) == ("faithful", 10, 5, 77)
    assert first.demonstrations == str(spec.parent / "human")
    assert (second.preset, second.time_limit, second.motion, second.improve) == ("fast", 3, "rrt", 5)


def test_a_sweep_is_a_grid_of_methods(spec: Path):
    """Every combination is a method, called after its values; its settings are other settings."""
    grid = "methods: [{method: Rnd+FPR, name: w, sweep: {candidates: [50, 100], keep_share: [0.1, 0.5]}}]"
    spec.write_text(SPEC.replace("methods: [Rnd+FPR, Rnd+R]", grid))
    study = read_study(spec)
    assert [method.name for method in study.methods] == [
        "w[candidates=50,keep_share=0.1]",
        "w[candidates=50,keep_share=0.5]",
        "w[candidates=100,keep_share=0.1]",
        "w[candidates=100,keep_share=0.5]",
    ]
    assert [(m.settings.candidates, m.settings.keep_share) for m in study.methods][1:3] == [(50, 0.5), (100, 0.1)]
    assert len({method.hash for method in study.methods}) == 4


def test_levels_are_converted_in_both_geometries(spec: Path):
    """A level set gives one scene per level and preset; a condition chooses among them, `take` thins them out."""
    source = "scenes: [{files: levels.xsb, presets: [clear, published]WHERE}]"
    for where, expected in {
        "": [("one", "clear"), ("two", "clear"), ("one", "published"), ("two", "published")],
        ", where: {occluded: true}": [("two", "clear"), ("two", "published")],
        ", where: {name: o*, objects: {min: 2}}": [("one", "clear"), ("one", "published")],
        ", take: 1": [("one", "clear"), ("one", "published")],
    }.items():
        spec.write_text(SPEC.replace("scenes: [scenes/*.yaml]", source.replace("WHERE", where)))
        assert [(scene.name, scene.preset) for scene in read_study(spec).scenes] == expected


@pytest.mark.parametrize("also", ["", ", must_move: 1", ", narrowest_passage_m: {max: 9}, monotone: true"])
def test_invalid_scenes_are_left_out_with_a_note(spec: Path, also: str):
    """In `published` the outer wall reaches to where the robot of the third level begins; alone that is refused.

    So it is where conditions need valid scenes.
    """
    (spec.parent / "levels.xsb").write_text(LEVELS + AT_THE_BORDER)
    source = "{files: levels.xsb, presets: [clear, published], where: {name: t*ALSO}}"
    text = SPEC.replace("scenes/*.yaml", source.replace("ALSO", also))
    spec.write_text(text)
    study = read_study(spec)
    assert [(scene.name, scene.preset) for scene in study.scenes] == [
        ("two", "clear"),
        ("three", "clear"),
        ("two", "published"),
    ]
    (note,) = study.notes
    expected = (
        r"scenes\[0\]: left out: 1 of 2 scenes in the geometry published, which are invalid .*; first three: agent"
    )
    assert re.search(expected, note)
    spec.write_text(text.replace("clear, ", "").replace("t*", "three"))
    with pytest.raises(InputError, match=r"none of the scenes in 'levels[.]xsb' meets the conditions and is valid"):
        read_study(spec)


def test_scenes_may_be_missing(spec: Path, monkeypatch: pytest.MonkeyPatch):
    """Optional files are left out with a note; a variable that is set leads to them."""
    monkeypatch.delenv("THEIR_SCENES", raising=False)
    spec.write_text(
        "name: test\nmethods: [Rnd+R]\nseeds: 1\n"
        "scenes: [scenes/one.yaml, {files: '${THEIR_SCENES}/two.yaml', optional: true}]\n"
    )
    study = read_study(spec)
    assert [scene.name for scene in study.scenes] == ["one"]
    (note,) = study.notes
    assert re.search(r"spec\.yaml: scenes\[1\]: left out: the environment variable THEIR_SCENES .* is not set", note)
    monkeypatch.setenv("THEIR_SCENES", str(spec.parent / "scenes"))
    assert [scene.name for scene in read_study(spec).scenes] == ["one", "two"]


def test_other_planners(spec: Path):
    """A function beside the file, with options and a grid over them, and a program; settings of ours are not theirs."""
    methods = (
        "methods: [{planner: 'their_module:solve', sweep: {depth: [1, 2]}}, "
        "{name: program, command: [./run, '{scene}'], options: {a: 1}, set: {time_limit: 5}}]"
    )
    spec.write_text(SPEC.replace("methods: [Rnd+FPR, Rnd+R]", methods))
    first, second, third = read_study(spec).methods
    assert [first.name, second.name] == ["their_module:solve[depth=1]", "their_module:solve[depth=2]"]
    assert (second.document["planner"], second.document["options"]) == ("their_module:solve", {"depth": 2})
    assert third.document["command"] == ["./run", "{scene}"]
    assert third.settings == Settings(time_limit=5)
    assert len({first.hash, second.hash, third.hash}) == 3


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seeds: 2", "seeds: [3, -1]", r"seeds\[1\]: .*greater than or equal to 0"),
        ("seeds: 2", "seeds: 0", "seeds: .*at least 1 item"),
        ("seeds: 2", "seeds: 99999999999", "seeds: .*at most 1000000 items"),
        ("seeds: 2", "seeds: [1, 1]", "seeds: .*an entry is given twice"),
        ("seeds: 2", "", "seeds: is missing"),
        ("Rnd+R]", "Rnd+X]", r"methods\[1\]: .*unknown method 'Rnd[+]X', allowed are Rnd[+]FPR"),
        ("Rnd+R]", "Rnd+FPR]", "methods: two inputs would be written as 'Rnd[+]FPR'"),
        ("Rnd+R]", "{}]", r"methods\[1\]: .*exactly one of method, planner, command is needed, found none"),
        ("Rnd+R]", "{method: MBTS, command: [x]}]", "exactly one of .*, found method and command"),
        ("Rnd+R]", "{method: MBTS, heuristic: 'm:f'}]", "go with methods of the forward search, found MBTS"),
        ("Rnd+R]", "{command: [x], settings: fast}]", "settings does not go with command"),
        ("Rnd+R]", "{command: [x], set: {motion: rrt}}]", "set: motion does not go with planner or command"),
        (
            "Rnd+R]",
            "{method: Rnd+R, set: {candidate: 1}}]",
            r"methods\[1\]: no setting 'candidate', allowed are .*cand",
        ),
        (
            "Rnd+R]",
            "{method: Rnd+R, set: {candidates: x}}]",
            r"methods\[1\]: candidates: .*valid integer.* [(]found 'x'[)]",
        ),
        ("Rnd+R]", "{method: Rnd+R, set: {candidates: 0}}]", r"methods\[1\]: candidates: found 0, must be at least 1"),
        (
            "Rnd+R]",
            "{planner: 'missing_module:f'}]",
            r"methods\[1\]: missing_module:f: cannot be imported: ModuleNotFound",
        ),
        (
            "Rnd+R]",
            "{planner: 'their_module:number'}]",
            "their_module:number: found a int, allowed is something that can",
        ),
        ("Rnd+R]", "{planner: nobody}]", "nobody: neither module:function nor an entry point of manipuzzle.planners"),
        ("scenes/*.yaml", "elsewhere/*.yaml", r"scenes\[0\]: nothing matches 'elsewhere/[*].yaml'"),
        ("scenes/*.yaml", "scenes/*.yaml, scenes/one.yaml", "scenes: two inputs would be written as 'one"),
        (
            "scenes/*.yaml",
            "{files: levels.xsb, where: {height: 1}}",
            r"scenes\[0\].where: no fact 'height' .*, allowed are name",
        ),
        ("scenes/*.yaml", "{files: levels.xsb, where: {name: {min: 1}}}", "name: found a range, but name is text"),
        ("scenes/*.yaml", "{files: levels.xsb, where: {objects: {}}}", "a range needs min or max"),
        (
            "scenes/*.yaml",
            "{files: levels.xsb, where: {objects: 9}}",
            "none of the scenes in 'levels.xsb' meets the cond",
        ),
        ("scenes/*.yaml", "{files: levels.xsb, take: 9}", r"scenes\[0\].take: 9 scenes are wanted, but there are 2"),
        ("scenes/*.yaml", "{files: levels.xsb, presets: [X]}", r"scenes\[0\].presets\[0\]: .*'clear' or 'published'"),
        ("seeds: 2", "seeds: 2\nworkers: 3", "workers: there is no such field"),
        ("seeds: 2", "seeds: 2\nhard_limit: 0.5", "hard_limit: .*greater than or equal to 1"),
        ("seeds: 2", "seeds: 2\nimprove: -1", "improve: .*greater than or equal to 0"),
        ("name: test", "name: [", "line"),
    ],
)
def test_bad_specifications(spec: Path, old: str, new: str, message: str):
    """Each mistake is one line that names the file and the field."""
    spec.write_text(SPEC.replace(old, new))
    with pytest.raises(InputError, match=message) as error:
        read_study(spec)
    assert str(error.value).startswith(str(spec))
    assert "\n" not in str(error.value)


def test_the_smoke_study_can_be_read():
    """The study that comes with the product names scenes and methods that exist."""
    study = read_study(Path(__file__).parents[2] / "data" / "studies" / "smoke.yaml")
    assert study.size == 18
