"""File names from the names of levels, scenes and methods."""

import re
from collections.abc import Sequence

from pcg.errors import InputError

MAX_LENGTH = 120
"""Longest name [characters]; file systems allow 255 bytes with suffixes."""

_UNSAFE = re.compile(r"[^A-Za-z0-9._+-]+")


def safe_name(name: str) -> str:
    """`name` as one harmless path component: no separators, blanks or leading dots, never empty.

    Letters, digits and `. _ + -` stay; each run of anything else becomes `_`.
    """
    return _UNSAFE.sub("_", name).lstrip(".")[:MAX_LENGTH] or "unnamed"


def counting_order(name: str) -> tuple[list[str | int], str]:
    """What to sort names by, so that numbers in them count: `m2-9` before `m2-10` before `m10-1`."""
    # Text and numbers alternate, so that like meets like.
    pieces: list[str | int] = [int(piece) if i % 2 else piece for i, piece in enumerate(re.split(r"(\d+)", name))]
    return pieces, name


def require_distinct(names: Sequence[str], what: str, sources: Sequence[str] | None = None) -> None:
    """Makes sure that no two results would be written to one file, on file systems that ignore case too.

    Args:
        names: File names about to be written.
        what: What is being named, for the message: `scenes`, `levels`.
        sources: Where each name comes from, for the message.

    Raises:
        InputError: two names agree.
    """
    first: dict[str, int] = {}
    for i, name in enumerate(names):
        other = first.setdefault(name.lower(), i)
        if other != i:
            both = "" if sources is None else f", {sources[other]} and {sources[i]}"
            raise InputError(
                what, f"two inputs would be written as {name!r}{both}; rename one or name them in two runs"
            )
