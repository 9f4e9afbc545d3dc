"""The corpus: levels of all agents, selected, split and documented.

Every agent makes `generated` levels with one seed; `kept` of them are chosen by `pcg.selection`, with a quota of
occluded ones. Level `m{K}-{index}` is number `index` of those that agent m{K} made. Within each agent the levels with the
smallest hashes are for testing, the others for training, so that both parts hold every agent. The same agents, weights,
seed and sizes give the same files, byte for byte, on the same processor type with the same libraries.
"""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from pcg.agents import Agent
from pcg.corpus_card import card
from pcg.files import write_text
from pcg.generate import generated_levels
from pcg.level_set import LEVELS_FILE, MANIFEST_FILE, GeneratedLevel, manifest_entry, read_manifest, write_level_set
from pcg.request import LevelSource
from pcg.selection import selected
from pcg.symmetry import content_hash, tiles_hash
from pcg.xsb import read_levels

CARD_FILE = "README.md"


@dataclass(frozen=True)
class CorpusSettings:
    """Sizes of a corpus; the defaults are those of the one that comes with the product.

    Attributes:
        generated: Levels that each agent makes.
        kept: Levels of each agent that are chosen.
        occluded: Occluded levels over all agents, divided among them as evenly as possible.
        test: Levels of each agent for testing.
        seed: Of every agent's run.
    """

    generated: int = 100
    kept: int = 10
    occluded: int = 122
    test: int = 2
    seed: int = 0

    def quotas(self, agents: int) -> list[int]:
        """How many levels of each agent have to be occluded."""
        return [self.occluded * (k + 1) // agents - self.occluded * k // agents for k in range(agents)]


def build_corpus(
    agents: Mapping[str, Agent],
    sources: Mapping[str, LevelSource],
    settings: CorpusSettings | None = None,
    progress: Callable[[int], None] | None = None,
) -> list[GeneratedLevel]:
    """The levels of the corpus, agent by agent.

    Args:
        agents: By name.
        sources: What makes each agent's levels, by its name.
        settings: Sizes.
        progress: Called after each agent, with the number of agents that are done.

    Raises:
        InputError: a source finds no more levels, or too few of a kind.
    """
    settings = settings or CorpusSettings()
    made = []
    for agent in agents.values():
        made.append(list(_generated(agent, sources[agent.name], settings)))
        if progress is not None:
            progress(len(made))
    choices = selected([[g.level for g in group] for group in made], settings.kept, settings.quotas(len(made)))
    return [level for group, places in zip(made, choices, strict=True) for level in _split(group, places, settings)]


def write_corpus(folder: Path, levels: list[GeneratedLevel], settings: CorpusSettings | None = None) -> None:
    """Writes `levels.xsb`, `manifest.jsonl` and the data card `README.md`.

    Raises:
        InputError: the folder cannot be written.
    """
    write_level_set(folder, levels)
    entries = [manifest_entry(level) for level in levels]
    write_text(folder / CARD_FILE, card(entries, (settings or CorpusSettings()).generated))


def differences(folder: Path, levels: list[GeneratedLevel]) -> Iterator[str]:
    """What of the corpus in `folder` differs from `levels`: names of levels, or of files with the same levels.

    Raises:
        InputError: a file of the folder cannot be read.
    """
    there = {level.name: level for level in read_levels(folder / LEVELS_FILE)}
    recorded = {entry.name: entry for entry in read_manifest(folder / MANIFEST_FILE)}
    for generated in levels:
        level = generated.level
        found = there.pop(level.name, None)
        if found is None or tiles_hash(found) != tiles_hash(level):
            yield f"{level.name}: {'not there' if found is None else 'other tiles'}"
        elif recorded.get(level.name) != manifest_entry(generated):
            yield f"{level.name}: other record in {MANIFEST_FILE}"
    yield from (f"{name}: not generated" for name in there)


def _generated(agent: Agent, source: LevelSource, settings: CorpusSettings) -> Iterator[GeneratedLevel]:
    stream = generated_levels(source, agent.request, settings.seed, agent.name)
    for index, generated in enumerate(islice(stream, settings.generated)):
        yield replace(generated, level=replace(generated.level, name=f"{agent.name}-{index}"))


def _split(group: list[GeneratedLevel], places: list[int], settings: CorpusSettings) -> list[GeneratedLevel]:
    kept = [group[place] for place in places]
    by_hash = sorted(kept, key=_split_hash)
    test = {generated.level.name for generated in by_hash[: settings.test]}
    return [replace(g, split="test" if g.level.name in test else "train") for g in kept]


def _split_hash(generated: GeneratedLevel) -> str:
    return hashlib.sha256(f"split {content_hash(generated.level)}".encode()).hexdigest()
