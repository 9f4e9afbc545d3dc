"""The data card of a corpus, made of its manifest so that it cannot disagree with it."""

from collections.abc import Callable, Sequence

import numpy as np

from pcg.level_set import ManifestEntry

_TEXT = """# The corpus: {n} Sokoban levels for sequential manipulation

{n} levels of 10 x 10 cells with two crates and one target, each solvable by its goal crate, no two of them the same under
turning and mirroring. `manipuzzle convert data/corpus --out out/scenes` makes scenes of them.

| file | content |
|---|---|
| `levels.xsb` | the levels, standard XSB text, a `; name` line each |
| `manifest.jsonl` | one line a level: provenance, statistics, verdicts, solution; `pcg.level_set.ManifestEntry` explains every field |

## How it was made

Each of the {agents} agents of `data/agents.yaml` (representation x band of wall density x band of pushes) made {generated}
levels with seed {seed}; {kept} of each were kept. The choice is deterministic: greedy farthest-point selection over all
agents, with a quota of occluded levels per agent (`pcg/selection.py`). Attempts that failed are counted in the manifest
by reason (`rejected`), {attempts} attempts for the kept levels in all, and no level was repaired. {weights}

`make corpus` builds the same files again; `make corpus-check` reports what differs on another machine.

## Statistics

{table}

Occluded: the ray between the centres of player and goal crate is blocked; by disc: the robot itself could not drive along
it. Dependency: the other crate has to move before the goal crate can reach its target, by pushing. Movable-critical:
solvable with the other crate ignored, unsolvable with it as a wall. Among solvable levels the two are the same.

## Split

`split` in the manifest: {train} levels `train`, {test} `test`, of each agent those with the smallest hash of their content.
Report results on `test` for whatever was fitted to `train`; planners that fit nothing use all.

## Licence and limits

MIT, like the code. The levels are synthetic and hold no personal data. They are small, and all of one size; their agents
cover the ranges of walls (7 to 26) and pushes (3 to 19) that published scenes of this kind have, evenly rather than in
proportion to what planners meet elsewhere.
"""


def card(entries: Sequence[ManifestEntry], generated: int) -> str:
    """The data card as Markdown.

    Args:
        entries: The manifest, at least one level.
        generated: Levels that each agent made.
    """
    agents = {entry.agent for entry in entries}
    hashes = {e.representation: e.weights_hash for e in entries if e.weights_hash is not None}
    weights = ", ".join(f"{name} `{digest[:16]}`" for name, digest in sorted(hashes.items(), key=str))
    return _TEXT.format(
        n=len(entries),
        agents=len(agents),
        generated=generated,
        kept=len(entries) // len(agents),
        seed=entries[0].seed,
        attempts=sum(1 + sum(entry.rejected.values()) for entry in entries),
        weights=f"SHA-256 of the weights: {weights}." if hashes else "The random baseline made them.",
        table=_table(entries),
        train=sum(entry.split == "train" for entry in entries),
        test=sum(entry.split == "test" for entry in entries),
    )


_ROWS: dict[str, Callable[[ManifestEntry], float | None]] = {
    "walls": lambda entry: entry.statistics.walls,
    "pushes (optimal)": lambda entry: entry.pushes,
    "moves of that solution": lambda entry: entry.moves,
}
_SHARES: dict[str, Callable[[ManifestEntry], bool | None]] = {
    "occluded": lambda entry: entry.occluded,
    "occluded by disc": lambda entry: entry.disc_occluded,
    "dependency": lambda entry: entry.dependency,
    "movable-critical": lambda entry: entry.movable_critical,
}


def _table(entries: Sequence[ManifestEntry]) -> str:
    parts = {
        "all": entries,
        "train": [entry for entry in entries if entry.split == "train"],
        "test": [entry for entry in entries if entry.split == "test"],
    }
    lines = [f"| | {' | '.join(parts)} |", f"|---|{'---|' * len(parts)}"]
    lines.append(f"| levels | {' | '.join(str(len(part)) for part in parts.values())} |")
    for name, value in _ROWS.items():
        cells = [_range([v for e in part if (v := value(e)) is not None]) for part in parts.values()]
        lines.append(f"| {name}: mean (least to most) | {' | '.join(cells)} |")
    for name, holds in _SHARES.items():
        cells = [_share([holds(entry) is True for entry in part]) for part in parts.values()]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _range(values: Sequence[float]) -> str:
    return f"{np.mean(values):.1f} ({min(values):g} to {max(values):g})" if values else "-"


def _share(flags: Sequence[bool]) -> str:
    return f"{sum(flags)} ({sum(flags) / len(flags):.1%})" if flags else "-"
