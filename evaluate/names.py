"""File names from the names of levels, scenes and methods."""

import re
from collections import Counter
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


def require_distinct(names: Sequence[str], what: str) -> None:
    """Makes sure that no two results would be written to one file, on file systems that ignore case too.

    Args:
        names: File names about to be written.
        what: What is being named, for the message: `scene`, `level`.

    Raises:
        InputError: two names agree.
    """
    counts = Counter(name.lower() for name in names)
    if repeated := sorted(name for name in names if counts[name.lower()] > 1):
        raise InputError(what, f"two inputs would be written as {repeated[0]!r}; rename one of them")
