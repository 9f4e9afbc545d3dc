"""The whole command line against hostile files, folders, names and numbers: one line, status 2, nothing elsewhere."""

import csv
import math
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from converter.plan import write_plan
from evaluate.cli import app
from tests.fuzz.parsers import LEVEL, prepare_folder, small_plan, trial_row, write_store

MEMORY_BYTES = 1 << 30
CPU_S = 10
"""More than the 5 s that parsers may take, for starting Python is in it."""

FILE_COMMANDS: dict[str, tuple[list[str], str]] = {
    "levels": (["levels", "{}"], ".xsb"),
    "convert levels": (["convert", "{}", "--out", "o"], ".xsb"),
    "convert yaml": (["convert", "{}", "--out", "o"], ".yaml"),
    "convert g": (["convert", "{}", "--out", "o"], ".g"),
    "check": (["check", "{}"], ".yaml"),
    "solve": (["solve", "{}", "--out", "o"], ".g"),
    "verify scene": (["verify", "{}", "plan.json"], ".yaml"),
    "verify plan": (["verify", "room.yaml", "{}"], ".json"),
    "render": (["render", "{}", "--out", "o"], ".json"),
    "export": (["export", "{}", "--out", "o"], ".json"),
    "demonstrate": (["demonstrate", "{}", "--out", "o/d.yaml", "--point", "obj:0,0"], ".yaml"),
    "subgoals": (["subgoals", "{}", "--out", "o"], ".yaml"),
    "tree": (["tree", "{}", "--out", "o"], ".yaml"),
    "study": (["study", "{}", "--out", "o"], ".yaml"),
    "report": (["report", "{}", "--out", "o"], ""),
    "published": (["report", "store", "--published", "{}", "--out", "o"], ".csv"),
    "trials": (["trials", "{}"], ""),
    "merge": (["merge", "{}", "--out", "o"], ""),
    "diff": (["diff", "{}", "store"], ""),
    "frozen": (["generate", "--frozen", "{}", "--out", "o"], ".txt"),
    "corpus plot": (["corpus", "plot", "{}", "--out", "o"], ""),
    "corpus check": (["corpus", "check", "{}"], ""),
}
"""Commands that read a file, with its suffix; those without read folders."""

CONTENTS = {
    "missing": None,
    "empty": b"",
    "any-bytes": bytes(range(256)),
    "nul": b"\0" * 100,
    "no-unicode": "é".encode("latin-1"),
    "braces": b"{{[[",
    "walls": b"#" * 50,
}

OUT_COMMANDS = [
    ["convert", "room.yaml"],
    ["solve", "room.yaml"],
    ["render", "plan.json"],
    ["export", "plan.json"],
    ["study", "study.yaml"],
    ["trials", "store"],
    ["merge", "store"],
    ["generate", "--count", "1"],
    ["subgoals", "room.yaml"],
    ["tree", "room.yaml"],
    ["corpus", "build"],
]

Run = Callable[..., Result]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where commands run, with a good file of each kind, in a folder that holds nothing else."""
    inside = tmp_path / "inside"
    inside.mkdir()
    monkeypatch.chdir(inside)
    prepare_folder(inside)
    write_plan(inside / "plan.json", small_plan())
    write_store(inside / "store", trial_row(), trial_row(key="01bb", seed=1))
    (inside / "study.yaml").write_text("name: a\nscenes: [room.yaml]\nmethods: [Rnd+R]\nseeds: 1\ntime_limit: 1\n")
    (inside / "file").write_text("x")
    (inside / "dangling").symlink_to("nowhere/x")
    return inside


@pytest.fixture
def run(folder: Path) -> Run:
    """Runs a command, which must leave everything outside of `o` as it was; SQLite's own files do not count."""

    def runner(*arguments: object) -> Result:
        before = files_in(folder.parent)
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit), arguments
        assert files_in(folder.parent) == before, arguments
        return result

    return runner


def files_in(folder: Path) -> dict[str, bytes]:
    """What all files below a folder hold, but for results."""
    found = (path for path in folder.rglob("*") if path.is_file() and path.parts[len(folder.parts) + 1] != "o")
    return {str(path): path.read_bytes() for path in found if not path.name.startswith("trials.sqlite-")}


def require_refusal(result: Result) -> None:
    """Status 2, one printable line on stderr, nothing on stdout."""
    assert (result.exit_code, result.stdout) == (2, ""), result.output
    assert result.stderr.startswith("error: ")
    assert result.stderr.removesuffix("\n").isprintable()


@pytest.mark.parametrize("command", FILE_COMMANDS)
def test_bad_files_are_refused_by_every_command(command: str, run: Run, folder: Path):
    """Missing, empty, binary, a folder instead of a file and the other way round, a device, a pipe, a name too long."""
    arguments, suffix = FILE_COMMANDS[command]
    names = [f"{name}{suffix}" for name in CONTENTS]
    for name, content in zip(names, CONTENTS.values(), strict=True):
        if content is not None:
            (folder / name).write_bytes(content)
    (folder / f"folder{suffix}").mkdir()
    (folder / f"link{suffix}").symlink_to("/dev/zero")
    os.mkfifo(folder / f"pipe{suffix}")
    for name in (*names, f"folder{suffix}", f"link{suffix}", f"pipe{suffix}", "x" * 300 + suffix, f"\x1b[31m{suffix}"):
        require_refusal(run(*(argument.format(name) for argument in arguments)))


@pytest.mark.parametrize("command", OUT_COMMANDS, ids=lambda command: command[0])
def test_folders_that_cannot_be_written_are_refused(command: list[str], run: Run):
    """A file instead of a folder, a folder below a file, one that nobody may make, a link to nowhere, a long name."""
    for out in ("file", "file/x", "/proc/nope", "dangling", "x" * 300):
        require_refusal(run(*command, "--out", out))


@pytest.mark.parametrize(
    "title", ["../../evil", "/root/evil", "..", "....//x", "a/../../b", "~root", "CON\\x", "x" * 5000]
)
@pytest.mark.parametrize("command", [["convert"], ["convert", "--to", "mjcf"], ["render"]], ids=" ".join)
def test_titles_of_levels_do_not_lead_elsewhere(title: str, command: list[str], run: Run, folder: Path):
    """What becomes of a level lies in the folder for results, whatever the level is called."""
    (folder / "a.xsb").write_text(LEVEL.replace("corridor", title))
    assert run(command[0], "a.xsb", *command[1:], "--out", "o").exit_code == 0
    (written,) = (folder / "o").iterdir()
    assert written.is_file()
    assert not written.is_symlink()


def test_results_replace_links_instead_of_following_them(run: Run, folder: Path):
    """A link in the folder for results, with the name of a result, costs its target nothing."""
    (folder / "o").mkdir()
    for name in ("room.yaml", "room.png", "room.svg"):
        (folder / "o" / name).symlink_to(folder / "file")
    assert run("convert", "room.yaml", "--out", "o").exit_code == 0
    assert run("render", "room.yaml", "--out", "o").exit_code == 0
    assert run("render", "room.yaml", "--out", "o", "--format", "svg").exit_code == 0
    assert (folder / "file").read_text() == "x"
    assert not any((folder / "o" / name).is_symlink() for name in ("room.yaml", "room.png", "room.svg"))


HTML = "<script>alert(1)</script><img src=x onerror=alert(2)>"
FORMULA = '=HYPERLINK("http://x")'
LATEX = "\\input{x} $\\undefined$ % & #"
MARKUP = [HTML, FORMULA, LATEX, "]]>--><!-- `a` | b", "[bold]x[/bold] \x1b[31m\u202e", "a\nb\tc"]


def test_markup_in_names_stays_text(run: Run, folder: Path):
    """Names in a database that could run in a page, a spreadsheet or a paper, or move the cursor of a terminal."""
    rows = [
        trial_row(key=f"{i:02x}", method=name, settings_hash=f"m{i}", seed=seed)
        for i, name in enumerate(MARKUP)
        for seed in (0,)
    ]
    write_store(folder / "o", *rows, name="<b>&amp;")
    result = run("report", "o", "--format", "html", "--format", "csv", "--format", "tex", "--format", "md")
    assert result.exit_code == 0
    assert "\x1b" not in result.output
    page = (folder / "o" / "report" / "report.html").read_text()
    assert "<script>alert" not in page
    assert "<img" not in page
    assert "<b>&amp;<" not in page
    tables = folder / "o" / "report" / "tables"
    for file in tables.glob("*.csv"):
        assert not any(cell.startswith("=") for row in csv.reader(file.read_text().splitlines()) for cell in row)
    for file in tables.glob("*.tex"):
        assert "\\input{x}" not in file.read_text()
        assert "\\undefined" not in file.read_text().replace("textbackslash{}undefined", "")
    for file in tables.glob("*.md"):
        assert "<script" not in file.read_text().replace("\\<script", "")
    assert "\x1b" not in run("trials", "o").output


def test_markup_in_file_names_stays_text(run: Run, folder: Path):
    """A plan's page shows the name of its file; a name cannot hold a slash, so the element is not closed."""
    (folder / "<img src=x onerror=alert(2)>.json").write_bytes((folder / "plan.json").read_bytes())
    assert run("render", "<img src=x onerror=alert(2)>.json", "--out", "o", "--format", "html").exit_code == 0
    for file in (folder / "o").iterdir():
        assert "<img" not in file.read_text()


NUMBERS = ["nan", "inf", "-inf", "-1", "0", "1e308", "1e-308", "1e9", "9" * 30, "x", ""]
NUMERIC = {
    "convert": (["convert", "level.xsb", "--out", "o"], ["cell", "agent-radius", "object-size", "goal-size", "wall-height",
                "size-jitter", "yaw-jitter", "seed", "goal-crate", "tolerance"]),
    "render": (["render", "plan.json", "--out", "o", "--format", "svg"], ["width", "speed"]),
    "export": (["export", "plan.json", "--out", "o"], ["speed", "acceleration", "grasp-time", "step"]),
    "check": (["check", "room.yaml", "--static"], ["tolerance", "push"]),
    "verify": (["verify", "room.yaml", "plan.json"], ["tolerance"]),
    "trials": (["trials", "store"], ["seed"]),
}  # fmt: skip


@pytest.mark.parametrize("command", NUMERIC)
def test_any_number_is_used_or_refused(command: str, run: Run):
    """Not numbers, infinite, negative, huge and tiny ones; warnings count as failures."""
    arguments, options = NUMERIC[command]
    for option in options:
        for number in NUMBERS:
            result = run(*arguments, f"--{option}={number}")
            if result.exit_code == 2:
                require_refusal(result)
            else:
                assert result.exit_code in (0, 1)
                # Constant speed, and way-points alone.
                assert option in ("acceleration", "step") or math.isfinite(float(number or "nan"))


@pytest.mark.parametrize("option", ["count", "max-pushes", "rows", "crates", "min-density"])
@pytest.mark.parametrize("number", ["nan", "-1", "9" * 30])
def test_no_levels_are_generated_for_senseless_numbers(option: str, number: str, run: Run):
    """Refused before any work."""
    require_refusal(run("generate", "--out", "o", f"--{option}={number}"))


@pytest.mark.parametrize("setting", ["candidates", "grasp_starts", "max_expansions", "improve"])
def test_settings_without_bounds_are_refused(setting: str, run: Run):
    """What would ask for all memory, or for ever."""
    require_refusal(run("solve", "room.yaml", "--out", "o", "--set", f"{setting}=1e999"))
    require_refusal(run("solve", "room.yaml", "--out", "o", "--set", f"{setting}=-5"))


def limited() -> None:
    """A process gets a gigabyte and some seconds, and is killed if it takes more."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S))


def crowd() -> bytes:
    """Two thousand objects, of which none overlaps another: millions of pairs."""
    small = "size: [0.01, 0.01, 0.1]}}"
    places = ((i / 100, j / 100) for i in range(0, 100, 2) for j in range(0, 80, 2))
    objects = "".join(f"- {{name: o{i}, position: [{x}, {y}, 0.05], {small}\n" for i, (x, y) in enumerate(places))
    return f"""\
format: 1
bounds: [[-2, -2], [2, 2]]
tolerance: 0.001
agent: {{position: [0, -1], radius: 0.1}}
goal: {{object: o0, position: [-1, 0], size: [1, 1]}}
objects:
{objects}""".replace("}}", "}").encode()


HUGE = {
    "crowd": ("a.yaml", crowd, ["solve", "a.yaml", "--out", "o"]),
    "levels": ("a.xsb", lambda: b"#\n" * 9_000_000, ["levels", "a.xsb"]),
    "scene": ("a.yaml", lambda: b"a: [" + b"0," * 3_900_000 + b"0]", ["convert", "a.yaml", "--out", "o"]),
    "rai": ("a.g", lambda: b"a { b:[" + b"0 " * 3_900_000 + b"] }", ["convert", "a.g", "--out", "o"]),
    "plan": ("a.json", lambda: b"[" + b"[]," * 6_000_000 + b"[]]", ["verify", "room.yaml", "a.json"]),
    "endless": ("a.json", None, ["render", "a.json", "--out", "o"]),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HUGE)
def test_huge_files_are_refused_in_bounded_time_and_memory(name: str, folder: Path):
    """The program itself, in a gigabyte."""
    file, make, arguments = HUGE[name]
    if make is None:
        (folder / file).symlink_to("/dev/zero")
    else:
        (folder / file).write_bytes(make())
    finished = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", "from evaluate.cli import main; main()", *arguments],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        preexec_fn=limited,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (finished.returncode, finished.stdout) == (2, ""), finished.stderr
    assert finished.stderr.count("\n") == 1
    assert finished.stderr.startswith("error: ")
