"""`manipuzzle corpus`: builds the corpus, and tells whether it can be built again."""

from collections.abc import Mapping
from pathlib import Path

from evaluate.expressive_range import expressive_range_figure
from evaluate.inputs import require_writable
from evaluate.output import print_json, print_line, progress
from evaluate.plot_style import FORMATS, write_figure
from pcg.agents import Agent, read_agents
from pcg.corpus import build_corpus, differences, write_corpus
from pcg.errors import InputError
from pcg.level_set import MANIFEST_FILE, GeneratedLevel, read_manifest
from pcg.policy_source import PolicySource, policies_of
from pcg.random_source import RandomSource
from pcg.request import LevelSource


def build(out: Path, *, baseline: bool, as_json: bool) -> bool:
    """Runs `corpus build`; see `evaluate.cli.corpus_build`."""
    require_writable(out)
    levels = _levels(baseline=baseline)
    write_corpus(out, levels)
    if as_json:
        print_json({"levels": len(levels), "out": str(out)})
    else:
        print_line(f"{len(levels)} levels written to {out}")
    return True


def check(folder: Path, *, baseline: bool, as_json: bool) -> bool:
    """Runs `corpus check`; see `evaluate.cli.corpus_check`."""
    read_manifest(folder / MANIFEST_FILE)
    found = list(differences(folder, _levels(baseline=baseline)))
    if as_json:
        print_json({"differences": found, "corpus": str(folder)})
    else:
        for difference in found:
            print_line(difference)
        print_line(f"{len(found)} differences between {folder} and what is built here")
    return not found


def plot(folders: list[Path], out: Path, format_: str, *, as_json: bool) -> bool:
    """Runs `corpus plot`; see `evaluate.cli.corpus_plot`."""
    if format_ not in FORMATS:
        raise InputError("--format", f"found {format_!r}, allowed are {', '.join(FORMATS)}")
    level_sets = {}
    for folder in folders:
        entries = [entry for entry in read_manifest(folder / MANIFEST_FILE) if entry.pushes is not None]
        if not entries:
            raise InputError(str(folder / MANIFEST_FILE), "no level with a solution")
        level_sets[folder.name if folder.name not in level_sets else str(folder)] = entries
    require_writable(out)
    path = out / f"expressive-range.{format_}"
    write_figure(path, expressive_range_figure(level_sets), format_)
    if as_json:
        print_json({"picture": str(path)})
    else:
        print_line(f"written to {path}")
    return True


def _levels(*, baseline: bool) -> list[GeneratedLevel]:
    agents = read_agents()
    sources = {name: RandomSource() for name in agents} if baseline else _policy_sources(agents)
    with progress() as bar:
        task = bar.add_task("agents", total=len(agents))
        return build_corpus(agents, sources, progress=lambda done: bar.update(task, completed=done))


def _policy_sources(agents: Mapping[str, Agent]) -> Mapping[str, LevelSource]:
    policies = policies_of(agents.values())
    return {name: PolicySource(policies[agent.representation]) for name, agent in agents.items()}
