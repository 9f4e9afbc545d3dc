"""Who may import what."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
PACKAGES = ("pcg", "converter", "planner", "evaluate")
"""In the order of dependence: each may import itself and those before it."""

COMMANDS = {f"evaluate/commands/{path.name}" for path in (ROOT / "evaluate" / "commands").glob("[a-z]*.py")}
"""The modules of the command line's commands, two of which take all their options from another."""

HOMES = {
    "PIL": {"converter/image_file.py"},
    "casadi": {
        "planner/lgp.py",
        "planner/lgp_constraints.py",
        "planner/lgp_scene.py",
        "planner/lgp_solver.py",
        "planner/nlp.py",
    },
    "cv2": {"converter/h264.py", "converter/image_file.py", "converter/raster.py"},
    "distributed": {"evaluate/cluster.py"},
    "gymnasium": {
        "pcg/environment.py",
        "pcg/train.py",
        "pcg/vector_environment.py",
        "pcg/wrappers.py",
    },
    "jinja2": {"converter/viewer_page.py", "evaluate/report_html.py"},
    "matplotlib": {
        "evaluate/expressive_range.py",
        "evaluate/plot_style.py",
        "evaluate/plots.py",
        "pcg/learning_curve.py",
    },
    "numba": {
        "pcg/dependency_kernel.py",
        "pcg/episode_kernel.py",
        "pcg/move_search.py",
        "pcg/push_search.py",
        "pcg/random_kernel.py",
        "pcg/region_kernel.py",
        "pcg/reward.py",
        "pcg/scalar_kernel.py",
        "pcg/solver_kernel.py",
        "pcg/statistics_kernel.py",
        "planner/contact_kernel.py",
        "planner/kernel.py",
        "planner/rrt_connect.py",
        "planner/shortcut.py",
        "planner/subgoals_bottleneck.py",
        "planner/visibility.py",
    },
    "onnx": {"pcg/export_policy.py"},
    "onnxruntime": {"pcg/policy.py"},
    "ompl": {"evaluate/bench_peers.py", "planner/motion_ompl.py"},
    "polars": {
        "evaluate/plots.py",
        "evaluate/report.py",
        "evaluate/scene_records.py",
        "evaluate/summary.py",
        "evaluate/tables.py",
        "evaluate/tables_methods.py",
        "evaluate/tables_scenes.py",
        "evaluate/tables_success.py",
        "evaluate/trial_frame.py",
    },
    "pymunk": {
        "converter/preview/checks.py",
        "converter/preview/driving.py",
        "converter/preview/playback.py",
        "converter/preview/simulation.py",
        "converter/preview/world.py",
    },
    "rich": {"evaluate/output.py"},
    "robotic": {"evaluate/bench_robotic.py"},
    "scipy": {"planner/subgoals_bottleneck.py"},
    "shapely": {"evaluate/bench_peers.py", "planner/penetration.py"},
    "stable_baselines3": {"pcg/train.py"},
    "torch": {"pcg/train.py"},
    "typer": {"evaluate/cli.py"} | (COMMANDS - {"evaluate/commands/space.py", "evaluate/commands/subgoals.py"}),
    "yaml": {"pcg/yaml_text.py"},
}
"""The only modules that import a library."""

EVERYWHERE = {"numpy", "pydantic"}
CLUSTER = {"distributed"}
"""Of the extra `cluster`."""
LEARNING = {"onnx", "stable_baselines3", "torch"}
"""Of the extra `rl`."""
PEERS = {"robotic"}
"""Compared with where installed, and no dependency."""

DISTRIBUTIONS = {
    "PIL": "pillow",
    "cv2": "opencv-python-headless",
    "stable_baselines3": "stable-baselines3",
    "yaml": "pyyaml",
}
"""Names on the package index, where they differ from the import's."""

MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def imports(path: Path) -> Iterator[str]:
    """Dotted names that a module imports, anywhere in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield node.module or ""


def libraries(path: Path) -> set[str]:
    """Top-level names of what a module imports from outside of project and standard library."""
    return {name.split(".")[0] for name in imports(path)} - set(PACKAGES) - sys.stdlib_module_names


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_go_one_way(path: Path):
    """Of pcg <- converter <- planner <- evaluate the later may import the earlier, never back."""
    rank = PACKAGES.index(path.relative_to(ROOT).parts[0])
    later = [name for name in imports(path) if name.split(".")[0] in PACKAGES[rank + 1 :]]
    assert later == []


def test_every_library_has_its_modules():
    """A library is imported where its use is to be expected, by these modules and no others."""
    found: dict[str, set[str]] = {}
    for path in MODULES:
        for library in libraries(path) - EVERYWHERE:
            found.setdefault(library, set()).add(str(path.relative_to(ROOT)))
    assert found == HOMES


def test_every_library_is_declared():
    """What is imported is what is installed, nothing less and nothing more."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = {requirement.split(">=")[0] for requirement in project["dependencies"]}
    assert declared == {
        DISTRIBUTIONS.get(name, name) for name in (HOMES.keys() | EVERYWHERE) - LEARNING - CLUSTER - PEERS
    }
    for extra, libraries_of_it in {"cluster": CLUSTER, "rl": LEARNING}.items():
        optional = {requirement.split(">=")[0] for requirement in project["optional-dependencies"][extra]}
        assert optional >= {DISTRIBUTIONS.get(name, name) for name in libraries_of_it}


@pytest.mark.parametrize(
    ("lock", "extras"), [("requirements.lock", ["cluster"]), ("requirements-rl.lock", ["cluster", "rl"])]
)
def test_locks_hold_what_is_declared(lock: str, extras: list[str]):
    """In a version that is allowed, for each Python one; every package with hashes, none with an address."""
    document = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    text = (ROOT / lock).read_text(encoding="utf-8")
    entries = [entry for entry in re.split(r"\n(?=\S)", text) if not entry.startswith("#")]
    assert all("--hash=sha256:" in entry for entry in entries)
    assert "://" not in text
    pythons = re.findall(r":: Python :: (3\.\d+)", "\n".join(document["project"]["classifiers"]))
    assert pythons
    locked = [Requirement(entry.partition("\\")[0]) for entry in entries]
    declared = [*document["project"]["dependencies"], *document["dependency-groups"]["dev"]]
    declared += [line for extra in extras for line in document["project"]["optional-dependencies"][extra]]
    for wanted in map(Requirement, declared):
        for python in pythons:
            (found,) = (r for r in locked if r.name == wanted.name and is_for(r, python))
            (version,) = found.specifier
            assert version.version in wanted.specifier, f"{found} on {python}"


def is_for(requirement: Requirement, python: str) -> bool:
    """Whether a requirement counts on Linux with that Python."""
    environment = {"python_version": python, "python_full_version": f"{python}.0", "sys_platform": "linux"}
    return requirement.marker is None or requirement.marker.evaluate(environment)


@pytest.mark.parametrize(
    ("module", "absent"),
    [
        ("pcg", "torch gymnasium numba yaml cv2 casadi ompl pymunk shapely rich"),
        ("converter", "torch numba cv2 casadi ompl pymunk shapely PIL rich"),
        ("planner", "torch cv2 casadi ompl pymunk PIL rich"),
        ("evaluate.cli", "torch numpy pydantic numba cv2 casadi ompl pymunk shapely PIL rich"),
        ("evaluate.commands.solve", "torch cv2 casadi ompl pymunk PIL"),
    ],
)
def test_importing_is_light(module: str, absent: str):
    """Libraries are loaded when they are used, so that programs start fast and need no graphics or learning."""
    script = f"import sys, {module}; print(*sorted(set(sys.modules) & set({absent.split()!r})))"
    found = subprocess.run(  # noqa: S603  # our own interpreter with our own script
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert found.stdout.split() == []
