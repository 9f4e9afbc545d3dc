"""`manipuzzle corpus`: builds the corpus, and tells whether it can be built again."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from evaluate.commands.options import Json, Out, application
from evaluate.expressive_range import expressive_range_figure
from evaluate.inputs import require_choice, require_writable
from evaluate.output import print_json, print_line, progress
from evaluate.plot_style import FORMATS, write_figure
from pcg.agents import Agent, read_agents
from pcg.corpus import build_corpus, differences, write_corpus
from pcg.errors import InputError
from pcg.level_set import MANIFEST_FILE, GeneratedLevel, read_manifest
from pcg.policy_source import PolicySource, policies_of
from pcg.random_source import RandomSource
from pcg.request import LevelSource

app = application(
    help="""Build the corpus of all agents, check that it can be built again, plot it.

    Example:  manipuzzle corpus check data/corpus
    """,
)

Baseline = Annotated[
    bool, typer.Option("--baseline", help="Let the random baseline answer the agents' requests, not their policies.")
]


@app.command(short_help="Generate, select, split and document the corpus.")
def build(*, out: Out, baseline: Baseline = False, json: Json = False) -> bool:
    """Let every agent of data/agents.yaml make 100 levels and keep 10: levels.xsb, manifest.jsonl and a data card.

    Example:  manipuzzle corpus build --out data/corpus
    """
    require_writable(out)
    levels = _levels(baseline=baseline)
    write_corpus(out, levels)
    if json:
        print_json({"levels": len(levels), "out": str(out)})
    else:
        print_line(f"{len(levels)} levels written to {out}")
    return True


@app.command(short_help="Build the corpus anew and compare.")
def check(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the corpus.")],
    *,
    baseline: Baseline = False,
    json: Json = False,
) -> bool:
    """Build the corpus anew, in memory, and report the levels that differ. Exit status 1 if one does.

    Example:  manipuzzle corpus check data/corpus
    """
    read_manifest(folder / MANIFEST_FILE)
    found = list(differences(folder, _levels(baseline=baseline)))
    if json:
        print_json({"differences": found, "corpus": str(folder)})
    else:
        for difference in found:
            print_line(difference)
        print_line(f"{len(found)} differences between {folder} and what is built here")
    return not found


@app.command(short_help="Draw the expressive range of level sets.")
def plot(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Level sets to plot.")],
    *,
    out: Out,
    format_: Annotated[str, typer.Option("--format", metavar="NAME", help="svg, pdf or png.")] = "png",
    json: Json = False,
) -> bool:
    """Draw histograms of walls and pushes, one a level set: DIR/expressive-range.{format}.

    Example:  manipuzzle corpus plot data/corpus out/levels --out out/pictures
    """
    require_choice("--format", format_, FORMATS)
    level_sets = {}
    for folder in folders:
        entries = [entry for entry in read_manifest(folder / MANIFEST_FILE) if entry.pushes is not None]
        if not entries:
            raise InputError(str(folder / MANIFEST_FILE), "no level with a solution")
        level_sets[folder.name if folder.name not in level_sets else str(folder)] = entries
    require_writable(out)
    path = out / f"expressive-range.{format_}"
    write_figure(path, expressive_range_figure(level_sets), format_)
    if json:
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
