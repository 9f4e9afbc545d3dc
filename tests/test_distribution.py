"""What the wheel and the source distribution hold."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path, PurePosixPath

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("pcg", "converter", "planner", "evaluate")
PICTURE = re.compile(r"!\[[^]]*\]\(([^)]+)\)")
LINK = re.compile(r"\]\(([^)]+)\)")
MEGABYTES = 8
"""More than this would be something that does not belong into a distribution: an environment, results, a cache."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the source distribution and the wheel that is built from it, as installers do."""
    uv = shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    if uv is None:
        pytest.skip("uv is not installed")
    folder = tmp_path_factory.mktemp("dist")
    built = subprocess.run(  # noqa: S603 - our own command
        [uv, "build", "--offline", "--quiet", "--python", sys.executable, "--out-dir", str(folder), str(ROOT)],
        capture_output=True,
        text=True,
        check=False,
    )
    if built.returncode != 0 and re.search("hatchling|hatch-fancy-pypi-readme", built.stderr):
        pytest.skip("the build backend is not in uv's cache")
    assert built.returncode == 0, built.stderr
    return folder


@pytest.fixture(scope="module")
def wheel(distributions: Path) -> zipfile.ZipFile:
    """The wheel."""
    return zipfile.ZipFile(next(distributions.glob("*.whl")))


@pytest.fixture(scope="module")
def source_files(distributions: Path) -> set[str]:
    """Paths in the source distribution, relative to its top folder."""
    with tarfile.open(next(distributions.glob("*.tar.gz"))) as archive:
        return {str(PurePosixPath(*PurePosixPath(name).parts[1:])) for name in archive.getnames()}


def files_of(*folders: str) -> set[str]:
    """Paths of all files below folders of the project, relative to it, without Python's caches."""
    found = (path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file())
    return {path.relative_to(ROOT).as_posix() for path in found if "__pycache__" not in path.parts}


def test_the_wheel_holds_packages_and_data(wheel: zipfile.ZipFile):
    """Every file of the packages, the data inside one of them, the metadata, and nothing else."""
    metadata = {name for name in wheel.namelist() if ".dist-info/" in name}
    data = {f"pcg/{name}" for name in files_of("data")}
    assert "pcg/data/puzzles/wall.yaml" in data
    assert set(wheel.namelist()) - metadata == files_of(*PACKAGES) | data
    assert any(name.endswith("licenses/LICENSE") for name in metadata)


def test_the_wheel_works_elsewhere(distributions: Path, tmp_path: Path):
    """Unpacked without the checkout the program finds its own data."""
    shutil.unpack_archive(next(distributions.glob("*.whl")), tmp_path / "site", "zip")
    script = "import sys; sys.argv[1:] = ['data']; from evaluate.cli import main; main()"
    printed = subprocess.run(  # noqa: S603 - our own interpreter with our own script
        [sys.executable, "-c", script],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert printed.stdout == f"{tmp_path / 'site' / 'pcg' / 'data'}\n"


def test_the_source_distribution_is_complete(source_files: set[str]):
    """It holds the tests, the data, what `make` needs and every picture of the README; no caches, no results."""
    pictures = set(PICTURE.findall((ROOT / "README.md").read_text(encoding="utf-8")))
    assert pictures
    needed = {"CHANGELOG.md", "LICENSE", "Makefile", "README.md", "pyproject.toml", "requirements.lock"}
    assert source_files >= files_of(*PACKAGES, "data", "tests") | pictures | needed
    assert not [name for name in source_files if re.search(r"__pycache__|^(out|dist|\.(venv|hypothesis))", name)]


def test_the_distributions_are_small(distributions: Path):
    """Neither takes more than a few megabytes."""
    sizes = {path.name: path.stat().st_size / 1e6 for path in distributions.iterdir()}
    assert max(sizes.values()) < MEGABYTES, sizes


def test_the_description_names_no_file(wheel: zipfile.ZipFile):
    """A package index shows it without the files beside the README: only addresses are linked, no pictures shown."""
    (name,) = (name for name in wheel.namelist() if name.endswith("dist-info/METADATA"))
    description = wheel.read(name).decode().partition("\n\n")[2]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(description) > 0.9 * len(readme)
    assert "Twelve plans with their verdicts" in description
    assert not [target for target in LINK.findall(description) if not target.startswith("https:")]


def test_all_name_the_same_version():
    """That of the package is the newest in the changelog, and the one that is cited."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    changelog, readme, citation = (
        (ROOT / name).read_text(encoding="utf-8") for name in ("CHANGELOG.md", "README.md", "CITATION.cff")
    )
    number, date = re.findall(r"^## \[(\d+\.\d+\.\d+)\] - (\S+)", changelog, re.MULTILINE)[0]
    assert number == version
    assert re.findall(r"^version: (.*)$", citation, re.MULTILINE) == [version]
    assert re.findall(r"^date-released: (.*)$", citation, re.MULTILINE) == [date]
    assert re.findall(r"^ +version = \{(.*)\}", readme, re.MULTILINE) == [version]
