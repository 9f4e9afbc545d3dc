"""Coverage-guided fuzzing of one parser: `make fuzz`, or `python -m tests.fuzz.coverage_guided scene-yaml --seconds 60`.

Inputs that add coverage are kept in the corpus folder, so that a later run goes on from there; one that makes a parser
raise anything but `InputError`, or take 5 s or 1 GB, is written beside it and ends the run. Needs the package atheris.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["pcg", "converter", "evaluate", "planner", "yaml", "json", "tests.fuzz"]):
    from tests.fuzz.parsers import PARSERS, complaint, prepare_folder

TIMEOUT_S, MEMORY_MB = 5, 1024
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
        f"-dict={words}",
        f"-max_total_time={arguments.seconds}",
        f"-runs={arguments.runs}",
        f"-timeout={TIMEOUT_S}",
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
        atheris.Setup([sys.argv[0], *options, str(corpus)], lambda data: complaint(parser, data, folder))
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
