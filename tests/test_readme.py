"""The commands in the README and in the page about the algorithm do what they say."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from converter import Status, read_scene
from planner import settings_for, solve

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PYTHON = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = (ROOT / "README.md", ROOT / "docs" / "algorithm.md")
NOT_RUN = ("make", "git clone", "cd ")
"""Beginnings of lines that are not run here: they set up what runs the tests."""


def lines() -> list[str]:
    """The lines of all shell blocks, without comments and blank lines; a backslash joins two."""
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES).replace("\\\n", " ")
    found = [line.strip() for block in BLOCK.findall(text) for line in block.splitlines()]
    return [line for line in found if line and not line.startswith("#")]


def test_make_targets_exist():
    """Every `make` command names targets of the Makefile."""
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    named = {word for line in lines() if line.startswith("make") for word in line.partition("#")[0].split()[1:]}
    assert named
    assert named <= targets


@pytest.mark.slow
def test_commands_run_as_shown(tmp_path: Path):
    """All commands run one after the other in an empty folder that holds the data; negatives are no failures."""
    shutil.copytree(ROOT / "data", tmp_path / "data")
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    commands = [line for line in dict.fromkeys(lines()) if not line.startswith(NOT_RUN)]
    assert any(line.startswith("manipuzzle") for line in commands)
    for command in commands:
        result = subprocess.run(  # noqa: S602 - the README's commands are shell commands
            command,
            shell=True,
            cwd=tmp_path,
            env={**os.environ, "PATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
        assert result.returncode in {0, 1}, f"{command}\n{result.stderr}"
        assert "Traceback" not in result.stderr, command


def test_python_examples_run(monkeypatch: pytest.MonkeyPatch):
    """Every Python block runs as it stands in the project's folder; its assertions hold."""
    monkeypatch.chdir(ROOT)
    blocks = PYTHON.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    assert blocks
    for block in blocks:
        exec(compile(block, "README.md", "exec"), {})  # noqa: S102  # our own README


@pytest.mark.parametrize("page", sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]), ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path):
    """Files that a page links to or shows exist, and so do the headings that it names."""
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        file, _, heading = target.partition("#")
        linked = page.parent / file if file else page
        assert linked.exists(), target
        assert not heading or heading in anchors(linked), target


def anchors(page: Path) -> set[str]:
    """The names by which the headings of a page are linked to."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^a-z0-9 -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_the_puzzle_in_the_formats_page_is_one(tmp_path: Path):
    """It is read and can be solved."""
    (text,) = re.findall(r"^```yaml\n(.*?)^```$", (ROOT / "docs" / "formats.md").read_text(), re.MULTILINE | re.DOTALL)
    file = tmp_path / "doorway.yaml"
    file.write_text(text, encoding="utf-8")
    scene, settings = read_scene(file), settings_for("fast", time_limit=900)
    assert solve(scene, settings, np.random.default_rng(0)).status is Status.SOLVED
