"""Names for file formats that allow less than ours: letters, digits and `_ . -`, no two alike."""

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence

_UNSAFE = re.compile(r"[^A-Za-z0-9_.-]+")


def safe_names(names: Sequence[str], reserved: Iterable[str] = ()) -> list[str]:
    """A harmless name for each of `names`, in their order.

    What a format cannot hold becomes `_`, a name that begins with no letter gets `n_` in front, and a name that is
    taken gets a number behind it. Names that differ only in case count as taken: some formats ignore case.

    Args:
        names: Any text.
        reserved: Names that must not be used, because they mean something else there.
    """
    taken = {name.lower() for name in reserved}
    # The number that a name has got last: thousands of names may be alike.
    numbers: defaultdict[str, int] = defaultdict(lambda: 1)
    safe = []
    for name in names:
        plain = _UNSAFE.sub("_", name)
        candidate = plain = plain if plain[:1].isalpha() else f"n_{plain}"
        while candidate.lower() in taken:
            numbers[plain.lower()] += 1
            candidate = f"{plain}_{numbers[plain.lower()]}"
        taken.add(candidate.lower())
        safe.append(candidate)
    return safe
