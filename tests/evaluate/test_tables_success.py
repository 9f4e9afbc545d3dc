"""Success by groups of scenes."""

from dataclasses import replace
from pathlib import Path

from evaluate.published import success_by_occlusion
from evaluate.scene_groups import Grouping, groupings
from evaluate.scene_statistics import SceneStatistics
from evaluate.tables_success import success_table
from evaluate.trial_frame import read_trials

FACTS = SceneStatistics(
    objects=2,
    walls=12,
    wall_density=0.12,
    occluded=False,
    narrowest_passage_m=0.4,
    must_move=1,
    pick_places=2,
    monotone=True,
)


def test_success_of_groups(two_methods: Path):
    """Runs are counted in all scenes and in each group; published shares stand beside theirs."""
    grouping = Grouping("occlusion", "occlusion", {"not occluded": ["wall"], "occluded": ["corner", "open"]})
    table = success_table(read_trials(two_methods), grouping, {("all", "A"): 0.997, ("occluded", "A"): 0.991})
    assert table.columns == ("scenes", "number", "A", "A (paper)", "Btl")
    assert [[entry.text for entry in row] for row in table.rows] == [
        ["all", "3", "60.0% (23 to 88) 3/5", "99.7%", "75.0% (30 to 95) 3/4"],
        ["not occluded", "1", "100% (34 to 100) 2/2", "", "50.0% (9 to 91) 1/2"],
        ["occluded", "2", "33.3% (6 to 79) 1/3", "99.1%", "100% (34 to 100) 2/2"],
    ]


def test_the_papers_shares():
    """As its text states them: all but one of 360 scenes, and what occlusion does to MBTS."""
    shares = success_by_occlusion()
    assert (shares["all", "Rnd+FPR"], shares["all", "MBTS"]) == (0.997, 0.736)
    assert (shares["not occluded", "MBTS"], shares["occluded", "MBTS"]) == (0.882, 0.451)


def test_groups():
    """Every scene is in one group of a grouping at most; groups come in rising order; groupings of one are left out."""
    facts = {
        "m3-1": FACTS,
        "m3-2": replace(FACTS, occluded=True, wall_density=0.31, pick_places=None, monotone=None),
        "b1-7": replace(FACTS, wall_density=0.05, pick_places=7, monotone=False, must_move=2),
    }
    found = {grouping.name: dict(grouping.groups) for grouping in groupings(facts)}
    assert found["occlusion"] == {"not occluded": ["m3-1", "b1-7"], "occluded": ["m3-2"]}
    assert found["agent"] == {"b1": ["b1-7"], "m3": ["m3-1", "m3-2"]}
    assert found["density"] == {"below 0.1": ["b1-7"], "0.1 to 0.15": ["m3-1"], "0.3 or more": ["m3-2"]}
    assert found["pick-places"] == {"2": ["m3-1"], "6 or more": ["b1-7"], "none known": ["m3-2"]}
    assert list(found["pick-places"]) == ["2", "6 or more", "none known"]
    assert found["monotone"] == {"monotone": ["m3-1"], "not monotone": ["b1-7"]}
    assert "passage" not in found


def test_each_geometry_has_its_own_groups_by_occlusion():
    """With scenes in two geometries there are two groupings by occlusion, of their scenes; with one there is one."""
    facts = {"a": FACTS, "b": replace(FACTS, occluded=True), "c": FACTS}
    presets = {"a": "clear", "b": "clear", "c": "published"}
    found = {grouping.name: dict(grouping.groups) for grouping in groupings(facts, presets)}
    assert found["occlusion-clear"] == {"not occluded": ["a"], "occluded": ["b"]}
    assert found["occlusion-published"] == {"not occluded": ["c"]}
    assert "occlusion" not in found
    assert [grouping.name for grouping in groupings(facts, dict.fromkeys(facts, "clear"))] == ["occlusion"]
