"""The commands that make levels: generate, corpus, compare-generators."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from evaluate.cli import app
from evaluate.commands import corpus as corpus_command
from pcg.agents import Agent, policy_path
from pcg.compare import standard_tasks
from pcg.corpus import CorpusSettings, build_corpus
from pcg.frozen import read_frozen
from pcg.level_set import read_level_set, read_manifest
from pcg.policy import load_policy
from pcg.request import Request

FROZEN = """\
########
#  ??? #
#@ ???.#
#??????#
########
"""

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs a command in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, list(arguments))


def document(result: Result) -> Any:
    """The one JSON document on stdout."""
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_generate_by_the_random_baseline(run: Run, tmp_path: Path):
    """Bands of pushes and walls are kept; attempts are counted, on stdout as in the manifest; nothing is repaired."""
    options = ["--min-pushes", "5", "--max-pushes", "8", "--min-density", "0.1", "--max-density", "0.12", "--occluded"]
    found = document(run("generate", "--count", "4", "--seed", "2", *options, "--out", "set", "--json"))
    entries = read_manifest(tmp_path / "set" / "manifest.jsonl")
    assert [entry.name for entry in entries] == [f"random-2-{k}" for k in range(4)]
    for entry in entries:
        assert entry.pushes is not None
        assert 5 <= entry.pushes <= 8
        assert 10 <= entry.statistics.walls <= 12
        assert entry.occluded
    thrown_away = sum(sum(entry.rejected.values()) for entry in entries)
    assert found["attempts"] == 4 + thrown_away
    assert sum(found["rejected"].values()) == thrown_away > 0
    assert found["repaired"] == 0
    assert found["steps"] == sum(entry.steps for entry in entries)


@pytest.mark.parametrize("agent", ["random", "m0", "m12", "m24"])
def test_agents_make_what_they_are_asked_for(run: Run, tmp_path: Path, agent: str):
    """Every representation; failures are counted, and provenance is recorded."""
    options = ["--min-pushes", "1", "--max-pushes", "100", "--max-density", "0.3", "--min-density", "0"]
    found = document(run("generate", "--agent", agent, "--count", "2", *options, "--out", "set", "--json"))
    entries = read_manifest(tmp_path / "set" / "manifest.jsonl")
    assert found["agent"] == agent
    assert [entry.name for entry in entries] == [f"{agent}-0-0", f"{agent}-0-1"]
    assert all((entry.weights_hash is None) == (agent == "random") for entry in entries)
    assert found["attempts"] == 2 + sum(sum(entry.rejected.values()) for entry in entries)
    again = document(run("generate", "--agent", agent, "--count", "2", *options, "--out", "again", "--json"))
    assert again == {**found, "out": "again"}


def test_policies_go_by_their_representation(run: Run, tmp_path: Path):
    """Without a band of its own, flip makes what is asked for, and its levels are called after it."""
    document(run("generate", "--agent", "flip", "--count", "2", "--min-pushes", "14", "--out", "s", "--json"))
    entries = read_manifest(tmp_path / "s" / "manifest.jsonl")
    assert [(entry.name, entry.representation) for entry in entries] == [("flip-0-0", "flip"), ("flip-0-1", "flip")]
    assert all(entry.pushes is not None and entry.pushes >= 14 for entry in entries)
    assert {entry.weights_hash for entry in entries} == {load_policy(policy_path("flip")).weights_hash}


def test_a_policy_of_ones_own(run: Run, tmp_path: Path):
    """Its file stands for an agent: levels of the size that it makes, called after its representation."""
    weights = str(policy_path("wide"))
    found = document(run("generate", "--agent", weights, "--count", "2", "--max-pushes", "11", "--out", "s", "--json"))
    assert found["agent"] == weights
    entries = read_manifest(tmp_path / "s" / "manifest.jsonl")
    assert [(entry.name, entry.agent) for entry in entries] == [("wide-0-0", "wide"), ("wide-0-1", "wide")]
    assert {entry.weights_hash for entry in entries} == {load_policy(Path(weights)).weights_hash}


@pytest.mark.parametrize("agent", ["random", "m12"])
def test_frozen_tiles_are_kept(run: Run, tmp_path: Path, agent: str):
    """Every level has them; their file decides on rows and columns, unless the policy has a size of its own."""
    (tmp_path / "frozen.txt").write_text(FROZEN if agent == "random" else ten_by_ten())
    options = ["--frozen", "frozen.txt", "--min-pushes", "1", "--max-pushes", "99", "--min-density", "0"]
    document(
        run("generate", "--agent", agent, "--count", "2", *options, "--max-density", "0.4", "--out", "s", "--json")
    )
    frozen = read_frozen(tmp_path / "frozen.txt")
    assert all(frozen.kept_by(level) for level in read_level_set(tmp_path / "s"))


def ten_by_ten() -> str:
    """Frozen tiles of the policies' size: a few walls."""
    return "\n".join(["#" * 12, "#??##??????#", *["#??????????#"] * 9, "#" * 12, ""])


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (
            ["--agent", "m36"],
            "--agent: found 'm36', allowed are random, m0 ... m35, narrow, turtle, wide, flip, FILE.onnx",
        ),
        (["--agent", "m0", "--rows", "7"], "policy narrow: asked for 7 x 10 cells"),
        (["--agent", "nothing.onnx"], "nothing.onnx: "),
        (["--frozen", "nothing.txt"], "nothing.txt: no such file"),
        (["--min-pushes", "9", "--max-pushes", "3"], "options: pushes (9, 3) must be a range"),
        (["--min-density", "2"], "Invalid value for '--min-density'"),
    ],
)
def test_bad_input_is_one_line(run: Run, arguments: list[str], problem: str):
    """Exit status 2, one line on stderr, nothing on stdout."""
    result = run("generate", *arguments, "--out", "o")
    assert (result.exit_code, result.stdout) == (2, "")
    assert problem in result.stderr
    assert result.stderr.count("\n") == 1


def test_corpus_is_built_checked_and_plotted(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """What build writes, check builds again; an edited level is reported with exit status 1; plot draws it."""
    agents = {name: Agent(name, "wide", Request()) for name in ("m0", "m1")}
    settings = CorpusSettings(generated=8, kept=2, occluded=2, test=1)
    monkeypatch.setattr(corpus_command, "read_agents", lambda: agents)
    monkeypatch.setattr(
        corpus_command,
        "build_corpus",
        lambda given, sources, progress: build_corpus(given, sources, settings, progress),
    )
    assert document(run("corpus", "build", "--baseline", "--out", "c", "--json"))["levels"] == 4
    assert document(run("corpus", "check", "c", "--baseline", "--json")) == {"differences": [], "corpus": "c"}
    assert run("levels", "c/levels.xsb").exit_code == 0
    text = (tmp_path / "c" / "levels.xsb").read_text()
    (tmp_path / "c" / "levels.xsb").write_text(text.replace("# ", "##", 1))
    result = run("corpus", "check", "c", "--baseline")
    assert result.exit_code == 1
    assert ": other tiles\n" in result.stdout
    picture = document(run("corpus", "plot", "c", "--out", "p", "--format", "svg", "--json"))["picture"]
    assert "<svg" in (tmp_path / picture).read_text()


def test_corpus_commands_refuse_bad_input(run: Run):
    """One line each."""
    for arguments, problem in (
        (["check", "nowhere"], "nowhere/manifest.jsonl: no such file"),
        (["plot", "nowhere", "--out", "o", "--format", "bmp"], "--format: found 'bmp', allowed are svg, pdf, png"),
        (["plot", "nowhere", "--out", "o"], "nowhere/manifest.jsonl: no such file"),
        ([], "Missing command"),
    ):
        result = run("corpus", *arguments)
        assert (result.exit_code, result.stdout) == (2, "")
        assert problem in result.stderr
        assert result.stderr.count("\n") == 1


def test_compare_writes_tables(run: Run, tmp_path: Path):
    """A row for every source in both tables, in Markdown and as measurements; an unknown task is refused."""
    task = standard_tasks()[0].name
    options = ["--seeds", "1", "--seconds", "0.05", "--max-levels", "3", "--task", task]
    options += ["--policy", str(policy_path("wide"))]
    found = document(run("compare-generators", "--out", "c", *options, "--json"))["measurements"]
    assert {m["task"] for m in found} == {task}
    sources = {m["source"] for m in found}
    assert {"random", "narrow", "untrained narrow", "turtle", "wide", "flip", str(policy_path("wide"))} <= sources
    assert len(found) == len(sources)
    assert len((tmp_path / "c" / "measurements.jsonl").read_text().splitlines()) == len(found)
    table = (tmp_path / "c" / "comparison.md").read_text()
    assert all(table.count(f"| {source} |") == 2 for source in sources)
    unknown = run("compare-generators", "--out", "c", "--task", "x")
    assert unknown.exit_code == 2
    assert "--task: found 'x', allowed are any level" in unknown.stderr
