import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import pytest

from pcg.agents import Agent, policy_path, read_agents
from pcg.corpus import CorpusSettings, build_corpus, differences, write_corpus
from pcg.corpus_card import card
from pcg.generate import generated_levels
from pcg.level_set import read_level_set, read_manifest
from pcg.metrics import occluded
from pcg.random_source import RandomSource
from pcg.report import report_levels, summarise
from pcg.request import Proposal, Request
from pcg.sokoban import apply_moves, is_solved
from pcg.swept_disc import disc_occluded
from pcg.symmetry import content_hash, symmetries

SHIPPED = Path(__file__).parents[2] / "data" / "corpus"
SETTINGS = CorpusSettings(generated=12, kept=4, occluded=5, test=1, seed=3)
AGENTS = {
    "m0": Agent("m0", "narrow", Request(pushes=(3, 8))),
    "m1": Agent("m1", "wide", Request(wall_density=(0.2, 0.26))),
    "m2": Agent("m2", "wide", Request(pushes=(7, 20))),
}
SOURCES = {name: RandomSource() for name in AGENTS}


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small corpus."""
    folder = tmp_path_factory.mktemp("corpus")
    write_corpus(folder, build_corpus(AGENTS, SOURCES, SETTINGS), SETTINGS)
    return folder


def test_quotas_are_even():
    """122 occluded levels of 36 agents: 14 times 4 and 22 times 3."""
    quotas = CorpusSettings().quotas(36)
    assert (sum(quotas), quotas.count(4), quotas.count(3)) == (122, 14, 22)


def test_the_shipped_corpus_is_what_its_card_says():
    """36 agents with ten levels each, two of them for testing; 122 occluded; walls, provenance and solutions."""
    levels, entries, agents = read_level_set(SHIPPED), read_manifest(SHIPPED / "manifest.jsonl"), read_agents()
    assert [level.name for level in levels] == [entry.name for entry in entries]
    assert len({entry.content_hash for entry in entries}) == len(entries) == 360
    assert Counter(entry.agent for entry in entries) == Counter(dict.fromkeys(agents, 10))
    occluded_by_agent = Counter(entry.agent for entry in entries if entry.occluded)
    assert Counter(occluded_by_agent.values()) == {4: 14, 3: 22}
    assert Counter(entry.agent for entry in entries if entry.split == "test") == Counter(dict.fromkeys(agents, 2))
    walls = [entry.statistics.walls for entry in entries]
    assert (min(walls), max(walls), round(sum(walls) / 360)) == (7, 26, 15)
    for level, entry in zip(levels, entries, strict=True):
        assert re.fullmatch(rf"{entry.agent}-[0-9]{{1,2}}", entry.name)
        request = agents[entry.agent].request
        assert (entry.solvable, entry.solvable_by_any, entry.seed) == (True, True, 0)
        assert request.pushes[0] <= (entry.pushes or 0) <= request.pushes[1]
        assert level.goal_crate == entry.goal_crate
        assert is_solved(apply_moves(level, entry.solution or ""))
        assert occluded(level, entry.goal_crate) == entry.occluded
        assert disc_occluded(level, entry.goal_crate) == entry.disc_occluded
    assert {entry.weights_hash for entry in entries} == {
        hashlib.sha256(policy_path(agent.representation).read_bytes()).hexdigest() for agent in agents.values()
    }
    assert (SHIPPED / "README.md").read_text() == card(entries, CorpusSettings().generated)


def test_a_corpus_is_what_was_asked_for(corpus: Path):
    """Numbers, names, occlusion, split, solvability by the goal crate, no duplicates."""
    levels, entries = read_level_set(corpus), read_manifest(corpus / "manifest.jsonl")
    summary = summarise(report_levels(levels))
    assert (summary.levels, summary.solvable, summary.occluded, summary.duplicates) == (12, 12, 5, 0)
    assert [entry.agent for entry in entries] == [name for name in AGENTS for _ in range(4)]
    for level, entry in zip(levels, entries, strict=True):
        assert level.name == entry.name
        agent, _, index = level.name.partition("-")
        assert agent == entry.agent
        assert 0 <= int(index) < 12
        assert level.goal_crate is not None
        assert occluded(level, level.goal_crate) == entry.occluded
        assert entry.solution is not None
        assert is_solved(apply_moves(level, entry.solution))
    for name in AGENTS:
        assert sum(entry.split == "test" for entry in entries if entry.agent == name) == 1


def test_building_again_gives_the_same_files(corpus: Path, tmp_path: Path):
    """Byte for byte, the data card too."""
    write_corpus(tmp_path, build_corpus(AGENTS, SOURCES, SETTINGS), SETTINGS)
    for name in ("levels.xsb", "manifest.jsonl", "README.md"):
        assert (tmp_path / name).read_bytes() == (corpus / name).read_bytes()


def test_levels_are_numbers_of_what_the_agent_made(corpus: Path):
    """Level m1-7 is number 7 of what agent m1 makes with the seed."""
    made = list(islice(generated_levels(SOURCES["m1"], AGENTS["m1"].request, SETTINGS.seed, "m1"), SETTINGS.generated))
    kept = [level for level in read_level_set(corpus) if level.name.startswith("m1-")]
    for level in kept:
        index = int(level.name.removeprefix("m1-"))
        assert content_hash(made[index].level) == content_hash(level)
        assert made[index].level.name == f"m1-3-{index}"


def test_differences_are_named(corpus: Path):
    """Levels with other tiles, missing ones, superfluous ones, other records; none for the corpus itself."""
    levels = build_corpus(AGENTS, SOURCES, SETTINGS)
    assert list(differences(corpus, levels)) == []
    renamed = replace(levels[0], level=replace(levels[0].level, name="m9-0"))
    other_tiles = replace(
        levels[1], level=replace(levels[2].level, name=levels[1].level.name), solution=levels[2].solution
    )
    other_record = replace(levels[3], seed=99)
    turned = replace(levels[4], level=symmetries(levels[4].level)[1])
    found = list(differences(corpus, [renamed, other_tiles, levels[2], other_record, turned, *levels[5:]]))
    assert found == [
        "m9-0: not there",
        f"{levels[1].level.name}: other tiles",
        f"{levels[3].level.name}: other record in manifest.jsonl",
        f"{levels[4].level.name}: other tiles",
        f"{levels[0].level.name}: not generated",
    ]


def test_the_card_counts_what_the_manifest_says(corpus: Path):
    """Numbers of levels, of the split and of occluded ones stand in the text."""
    text = (corpus / "README.md").read_text()
    entries = [json.loads(line) for line in (corpus / "manifest.jsonl").read_text().splitlines()]
    walls = [entry["statistics"]["walls"] for entry in entries]
    assert "| levels | 12 | 9 | 3 |" in text
    assert f"| {sum(walls) / 12:.1f} ({min(walls)} to {max(walls)}) |" in text
    assert "| occluded | 5 (41.7%) |" in text
    assert "The random baseline made them." in text
    assert "seed 3; 4 of each were kept" in " ".join(text.split())


@dataclass(frozen=True)
class FewVisible:
    """A source whose levels are all occluded."""

    representation: None = None
    weights_hash: str | None = "ab" * 32

    def proposals(self, request: Request, seed: int) -> Iterator[Proposal]:
        """Those of the random baseline."""
        return RandomSource().proposals(replace(request, occluded=True), seed)


def test_weights_are_named_on_the_card(tmp_path: Path):
    """The hash of a policy's file, shortened."""
    settings = replace(SETTINGS, occluded=4, test=2)
    write_corpus(tmp_path, build_corpus({"m0": AGENTS["m0"]}, {"m0": FewVisible()}, settings), settings)
    assert "`abababababababab`" in (tmp_path / "README.md").read_text()
