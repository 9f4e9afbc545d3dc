"""Reports of studies, in a real browser where there is one."""

import json
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from evaluate.cli import app

HOSTILE = "--></script><script>window.hacked=1</script><img src=x onerror='window.hacked=2'>$\\frac{"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def run_report(folder: Path, *options: str) -> dict[str, Any]:
    """Runs the command and returns its JSON document."""
    result = CliRunner().invoke(app, ["report", str(folder), "--json", *options])
    assert result.exit_code == 0, result.output
    document: dict[str, Any] = json.loads(result.stdout)
    return document


@pytest.mark.slow
def test_files(two_methods: Path):
    """One page, every table in three formats, every plot in three, and all rows; the same page the second time."""
    document = run_report(two_methods, "--published", "paper")
    assert (document["trials"], document["solved"]) == (9, 6)
    files = [Path(file) for file in document["files"]]
    assert files[0] == two_methods / "report" / "report.html"
    names = {file.name for file in files}
    assert {"trials.parquet", "times.md", "times.tex", "times.csv", "methods.md", "comparisons.csv"} <= names
    assert {"times.svg", "times.pdf", "times.png", "solved-within.pdf"} <= names
    before = files[0].read_bytes()
    run_report(two_methods, "--published", "paper", "--format", "html")
    assert files[0].read_bytes() == before


def test_chosen_formats(two_methods: Path, tmp_path: Path):
    """`--format` limits what is written, `--out` says where to."""
    document = run_report(two_methods, "--format", "md", "--out", str(tmp_path / "out"))
    assert {Path(file).suffix for file in document["files"]} == {".md"}
    assert all(Path(file).is_relative_to(tmp_path / "out") for file in document["files"])


@pytest.mark.parametrize(
    ("options", "problem"),
    [(["--format", "docx"], "allowed are html"), (["--published", "missing.csv"], "no such file")],
)
def test_bad_options(two_methods: Path, options: list[str], problem: str):
    """One line, exit status 2."""
    result = CliRunner().invoke(app, ["report", str(two_methods), *options])
    assert result.exit_code == 2
    assert problem in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_no_study(tmp_path: Path):
    """A folder without a study is refused in one line."""
    result = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert result.exit_code == 2
    assert "no study" in result.stderr


@pytest.fixture
def page_path(make_study: Callable[..., Path], make_run: Callable[..., Any]) -> Path:
    """The page of a study with three scenes: always, sometimes and never solved; one has a hostile name."""
    runs = [
        make_run("wall", "A", 0, 3.0),
        make_run("wall", "B", 0, 2.0),
        make_run(HOSTILE, "A", 0, 1.0),
        make_run(HOSTILE, "B", 0, None),
        make_run("corner", "A", 0, None),
        make_run("corner", "B", 0, None),
    ]
    return Path(run_report(make_study(runs), "--format", "html")["files"][0])


def test_the_page_is_self_contained(page_path: Path):
    """Nothing is loaded from elsewhere, and names are escaped."""
    text = page_path.read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    assert not re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', text)
    assert "<script>window.hacked" not in text
    assert "<img src=x" not in text


@pytest.fixture
def page(page_path: Path) -> Iterator[Any]:
    """The page, open in a browser; the test fails on any message, error or request."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no Chromium here")
    troubles: list[str] = []
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        opened = browser.new_page()
        opened.set_default_timeout(120_000)
        opened.on("console", lambda message: troubles.append(message.text))
        opened.on("pageerror", lambda error: troubles.append(str(error)))
        opened.on("request", lambda request: troubles.append(request.url) if _is_remote(request.url) else None)
        opened.goto(page_path.as_uri())
        yield opened
        assert opened.evaluate("window.hacked") is None
        browser.close()
    assert troubles == []


def _is_remote(url: str) -> bool:
    return not url.startswith(("file:", "data:", "blob:"))


@pytest.mark.slow
def test_the_page_in_a_browser(page: Any):
    """Tables sort by value with blanks last, the gallery filters by verdict, a click plays the plan."""
    _sorts(page)
    _filters(page)
    _plays(page)


def _sorts(page: Any) -> None:
    head = page.locator("#table-times thead button").nth(1)
    values = "Array.from(document.querySelectorAll('#table-times tbody tr'), row => row.cells[1].dataset.value ?? '-')"
    assert page.evaluate(values) == ["3", "1", "-"]
    head.click()
    assert page.evaluate(values) == ["1", "3", "-"]
    head.click()
    assert page.evaluate(values) == ["3", "1", "-"]
    assert page.locator("#table-times th[aria-sort=descending]").count() == 1


def _filters(page: Any) -> None:
    names = "Array.from(document.querySelectorAll('.tile:not([hidden]) b'), name => name.textContent)"
    assert page.evaluate(names) == ["wall", HOSTILE, "corner"]
    for verdict, shown in {"always": ["wall"], "sometimes": [HOSTILE], "never": ["corner"]}.items():
        page.select_option("#verdict", verdict)
        assert page.evaluate(names) == shown
        assert page.locator("#shown").inner_text() == "1 of 3 scenes"
    page.select_option("#verdict", "always")
    page.select_option("#method", "A")
    assert page.evaluate(names) == ["wall", HOSTILE]
    page.fill("#name", "WAL")
    assert page.evaluate(names) == ["wall"]


def _plays(page: Any) -> None:
    page.locator("button.tile:not([hidden])").click()
    page.wait_for_selector("#player[open] .stage svg")
    assert page.locator("#player h3").inner_text() == "wall"
    assert "2 pick-places" in page.locator("#player p").first.inner_text()
    page.wait_for_function("Number(document.querySelector('#player input[type=range]').value) > 0")
    page.locator("#player > header button").click()
    assert page.locator("#player .stage > *").count() == 0
