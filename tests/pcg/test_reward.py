import numpy as np
import pytest

from pcg import reward as terms
from pcg.reward import Control, RewardSettings, Weights, distances, outside, reward
from pcg.statistics_kernel import Column

SETTINGS = RewardSettings()


def row(**values: int) -> np.ndarray:
    """Statistics of a good map with 8 pushes, apart from `values`."""
    good = {"PLAYERS": 1, "CRATES": 2, "TARGETS": 1, "WALLS": 15, "REGIONS": 1, "SOLVABLE": 1, "PUSHES": 8}
    found = np.zeros(len(Column), dtype=np.int32)
    for name, value in {**good, **values}.items():
        found[Column[name]] = value
    return found


def controls(**values: float) -> np.ndarray:
    """Wants 10 to 20 walls and 6 to 9 pushes, apart from `values`."""
    asked = np.zeros(len(Control))
    for name, value in {"WALLS_LOW": 10, "WALLS_HIGH": 20, "PUSHES_LOW": 6, "PUSHES_HIGH": 9, **values}.items():
        asked[Control[name]] = value
    return asked


def distance(statistics: np.ndarray, asked: np.ndarray, settings: RewardSettings = SETTINGS) -> float:
    """The distance of one map."""
    out = np.zeros(1)
    distances(statistics[None], asked[None], np.array([0]), settings.wanted(), out)
    return float(out[0])


@pytest.mark.parametrize(("value", "expected"), [(1, 2), (3, 0), (5, 0), (9, 4)])
def test_distance_to_a_range(value: float, expected: float):
    """It is 0 inside, with both ends, and grows by one a unit outside."""
    assert outside(value, 3, 5) == expected


@pytest.mark.parametrize(
    ("weight", "found", "asked", "expected"),
    [
        ("player", {"PLAYERS": 0}, {}, 1),
        ("player", {"PLAYERS": 3}, {}, 2),
        ("crates", {"CRATES": 5}, {}, 3),
        ("targets", {"TARGETS": 0}, {}, 1),
        ("regions", {"REGIONS": 4}, {}, 3),
        ("walls", {"WALLS": 7}, {}, 3),
        ("walls", {"WALLS": 22}, {}, 2),
        ("pushes", {"PUSHES": 2}, {}, 4),
        ("pushes", {"PUSHES": 12}, {}, 3),
        ("occlusion", {"OCCLUDED": 0}, {"OCCLUDED": 1}, 1),
        ("occlusion", {"OCCLUDED": 1}, {"OCCLUDED": -1}, 1),
        ("occlusion", {"OCCLUDED": 1}, {"OCCLUDED": 1}, 0),
        ("occlusion", {"OCCLUDED": 0}, {"OCCLUDED": -1}, 0),
        ("occlusion", {"OCCLUDED": 1}, {}, 0),
        ("dependency", {"DEPENDENCY": 0}, {"DEPENDENCY": 1}, 1),
        ("dependency", {"DEPENDENCY": 1}, {"DEPENDENCY": 1}, 0),
    ],
)
def test_each_term_alone(weight: str, found: dict[str, int], asked: dict[str, float], expected: float):
    """With one weight left the distance is that of one quantity to its target."""
    weights = Weights(**{name: float(name == weight) for name in Weights().__dict__})
    assert distance(row(**found), controls(**asked), RewardSettings(weights=weights)) == expected


def test_unsolvable_maps_are_one_away_and_have_no_pushes():
    """An unsolvable map misses solvability, the whole lower end of the push band, and every flag that is asked for."""
    unsolved = row(SOLVABLE=0, PUSHES=0)
    w = SETTINGS.weights
    assert distance(unsolved, controls()) == w.solvable + 6 * w.pushes
    flags = controls(OCCLUDED=-1, DEPENDENCY=1)
    assert distance(unsolved, flags) == w.solvable + 6 * w.pushes + w.occlusion + w.dependency


def test_clearance_and_novelty_count_when_they_have_a_weight():
    """They are left out by default, and missing cells count with a weight."""
    assert distance(row(), controls()) == 0
    settings = RewardSettings(clearance=3, novelty=12, weights=Weights(clearance=1.0, novelty=0.1))
    assert distance(row(CLEARANCE=1, NOVELTY=2), controls(), settings) == pytest.approx(2 + 1)
    assert distance(row(CLEARANCE=4, NOVELTY=100), controls(), settings) == 0


def test_terms_and_weights_belong_together():
    """Each weight has the term of its name, in the order of the sum."""
    assert all(hasattr(terms, name) for name in Weights().__dict__)
    assert SETTINGS.wanted().weights.tolist() == list(Weights().__dict__.values())


def test_the_reward_is_the_decrease_and_a_bonus_at_zero():
    """Nearing the target pays, leaving it costs the same, and arriving pays the bonus."""
    before, after = np.array([4.0, 2.0, 1.0]), np.array([2.0, 4.0, 0.0])
    expected = SETTINGS.scale * np.array([2.0, -2.0, 1.0 + SETTINGS.bonus])
    assert reward(before, after, SETTINGS) == pytest.approx(expected)


@pytest.mark.parametrize(("crates", "targets"), [(1, 2), (2, 0)])
def test_impossible_targets_are_refused(crates: int, targets: int):
    """There is at least one target, and a crate for each."""
    with pytest.raises(ValueError, match="targets need as many crates"):
        RewardSettings(crates=crates, targets=targets)
