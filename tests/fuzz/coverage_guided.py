"""Coverage-guided fuzzing of one parser: `make fuzz`, or `python -m tests.fuzz.coverage_guided scene-yaml --seconds 60`.

Inputs that add coverage are kept in the corpus folder, so that a later run goes on from there; one that makes a parser
raise anything but `InputError`, or take 5 s of the processor or 1 GB, is written beside it and ends the run. Needs the
package atheris.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

import atheris

INSTRUMENTED = ["pcg", "converter", "evaluate", "planner", "yaml", "json", "tests.fuzz"]
ROOT = Path(__file__).parents[2]


def compiled_modules() -> list[str]:
    """Modules that Numba compiles, which it could not if they were instrumented."""
    sources = (path for package in ("pcg", "planner") for path in (ROOT / package).glob("*.py"))
    return [f"{path.parent.name}.{path.stem}" for path in sources if "numba" in path.read_text(encoding="utf-8")]


with atheris.instrument_imports(include=INSTRUMENTED, exclude=compiled_modules()):
    from tests.fuzz.parsers import PARSERS, complaint, prepare_folder

CPU_S, WALL_S, MEMORY_MB = 5, 60, 1024
"""An input may take this; the wall time is for what never ends, on a machine with other work."""

MAX_LENGTH = 20_000
"""Bytes of an input; larger ones are for tests of their own."""


def main() -> None:
    """Runs libFuzzer, which ends the process."""
    arguments = _arguments()
    parser = PARSERS[arguments.parser]
    corpus = arguments.out / arguments.parser
    corpus.mkdir(parents=True, exist_ok=True)
    for i, seed in enumerate(parser.seeds()):
        (corpus / f"seed-{i}").write_bytes(seed[:MAX_LENGTH])
    words = arguments.out / f"{arguments.parser}.dict"
    words.write_text("".join(f'"{_escaped(word)}"\n' for word in parser.words))
    options = [
        *([f"-dict={words}"] if parser.words else []),
        f"-max_total_time={arguments.seconds}",
        f"-runs={arguments.runs}",
        f"-timeout={WALL_S}",
        f"-rss_limit_mb={MEMORY_MB}",
        f"-max_len={MAX_LENGTH}",
        f"-artifact_prefix={arguments.out}/{arguments.parser}-",
        "-print_final_stats=1",
        "-verbosity=1",
    ]
    # In memory where there is such a file system, for there is one file per input.
    shared = Path("/dev/shm")  # noqa: S108 - the folder in it has a random name
    with tempfile.TemporaryDirectory(dir=shared if shared.is_dir() else None) as name:
        folder = Path(name)
        prepare_folder(folder)
        # Whatever is compiled is compiled now.
        for seed in parser.seeds():
            complaint(parser, seed, folder)

        def run(data: bytes) -> None:
            began = time.process_time()
            complaint(parser, data, folder)
            if (took := time.process_time() - began) > CPU_S:
                raise TimeoutError(f"took {took:.1f} s")

        atheris.Setup([sys.argv[0], *options, str(corpus)], run)
        atheris.Fuzz()


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parser", choices=PARSERS)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--runs", type=int, default=-1)
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    return parser.parse_args()


def _escaped(word: str) -> str:
    return "".join(c if c.isalnum() else "".join(f"\\x{byte:02x}" for byte in c.encode()) for c in word)


if __name__ == "__main__":
    main()
