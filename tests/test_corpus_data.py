"""The corpus that comes with the product is what its data card says, whoever made it."""

from collections import Counter
from pathlib import Path

import pytest

from pcg.agents import read_agents
from pcg.corpus_card import card
from pcg.dependency import has_dependency
from pcg.level import Level
from pcg.level_set import ManifestEntry, read_level_set, read_manifest
from pcg.metrics import occluded, statistics
from pcg.sokoban import apply_moves, is_solved
from pcg.solver import solve
from pcg.swept_disc import disc_occluded
from pcg.symmetry import content_hash, tiles_hash

CORPUS = Path(__file__).parents[1] / "data" / "corpus"

pytestmark = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus is not built: manipuzzle corpus build")


@pytest.fixture(scope="module")
def corpus() -> list[tuple[Level, ManifestEntry]]:
    """Levels with their records."""
    return list(zip(read_level_set(CORPUS), read_manifest(CORPUS / "manifest.jsonl"), strict=True))


def test_ten_levels_of_every_agent(corpus: list[tuple[Level, ManifestEntry]]):
    """36 agents, names that say agent and number, two levels of each for testing, no level twice."""
    assert Counter(entry.agent for _, entry in corpus) == dict.fromkeys(read_agents(), 10)
    for level, entry in corpus:
        agent, _, index = entry.name.partition("-")
        assert (agent, level.name) == (entry.agent, entry.name)
        assert 0 <= int(index) < 100
    assert Counter(e.agent for _, e in corpus if e.split == "test") == dict.fromkeys(read_agents(), 2)
    assert len({content_hash(level) for level, _ in corpus}) == 360


def test_every_level_is_what_its_agent_was_asked_for(corpus: list[tuple[Level, ManifestEntry]]):
    """Size, things, walls and pushes; the least number of pushes is computed anew."""
    agents = read_agents()
    for level, entry in corpus:
        request, counted = agents[entry.agent].request, statistics(level)
        assert (counted.rows, counted.columns, counted.players, counted.regions) == (10, 10, 1, 1)
        assert (counted.crates, counted.targets) == (2, 1)
        assert round(100 * request.wall_density[0]) <= counted.walls <= round(100 * request.wall_density[1])
        solution = solve(level)
        assert solution.pushes is not None
        assert request.pushes[0] <= solution.pushes <= request.pushes[1]
        assert entry.representation == agents[entry.agent].representation


def test_the_records_are_true(corpus: list[tuple[Level, ManifestEntry]]):
    """Solutions solve, verdicts and hashes are computed anew."""
    for level, entry in corpus:
        assert entry.tiles_hash == tiles_hash(level)
        assert entry.solution is not None
        assert level.goal_crate is not None
        assert is_solved(apply_moves(level, entry.solution))
        assert entry.pushes == sum(letter.isupper() for letter in entry.solution)
        assert entry.occluded == occluded(level, level.goal_crate)
        assert entry.disc_occluded == disc_occluded(level, level.goal_crate)
        assert entry.dependency == entry.movable_critical == has_dependency(level)
        assert (entry.solvable, entry.solvable_by_any) == (True, True)


def test_occlusion_and_walls_are_distributed_as_announced(corpus: list[tuple[Level, ManifestEntry]]):
    """122 occluded levels, three or four of each agent; 7 to 26 walls, 15 on the average."""
    occluded_by_agent = Counter(entry.agent for _, entry in corpus if entry.occluded)
    assert Counter(occluded_by_agent.values()) == {4: 14, 3: 22}
    walls = [entry.statistics.walls for _, entry in corpus]
    assert 7 <= min(walls) < max(walls) <= 26
    assert 14 < sum(walls) / len(walls) < 16


def test_the_card_belongs_to_the_manifest(corpus: list[tuple[Level, ManifestEntry]]):
    """The text is made of these records."""
    assert (CORPUS / "README.md").read_text(encoding="utf-8") == card([entry for _, entry in corpus], 100)


def test_policies_made_the_levels(corpus: list[tuple[Level, ManifestEntry]]):
    """One hash of weights for each representation."""
    hashes = {(entry.representation, entry.weights_hash) for _, entry in corpus}
    assert sorted(str(name) for name, _ in hashes) == ["narrow", "turtle", "wide"]
    assert all(digest is not None for _, digest in hashes)
