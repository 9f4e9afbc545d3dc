"""Single settings of the planner given by name: in a study's file, and by `--set` on the command line."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pcg.errors import InputError
from planner import Settings

MAX_COUNT = 1_000_000
"""Largest number of candidates, iterations and the like: memory may grow with it."""

_TYPES: dict[str, Any] = {
    field.name: field.type for field in fields(Settings) if field.name not in ("method", "preset")
}
"""Types by name; method and preset have ways of their own."""


def changed(settings: Settings, changes: Mapping[str, Any], where: str) -> Settings:
    """The settings with other values for some.

    Args:
        settings: What to begin with.
        changes: Values by name; text is taken for the number or truth value that it stands for.
        where: What they were read from; it begins the message.

    Raises:
        InputError: a setting does not exist, or a value is not allowed.
    """
    try:
        return replace(settings, **{name: _value(name, value, where) for name, value in changes.items()})
    except InputError as error:
        message = str(error)
        raise InputError("" if message.startswith(where) else where, message) from None


def assignments(texts: Sequence[str], where: str) -> dict[str, str]:
    """The values in texts like `candidates=50`.

    Raises:
        InputError: one is no assignment, or a name is given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name:
            raise InputError(where, f"found {text!r}, must be NAME=VALUE")
        if name in found:
            raise InputError(where, f"{name} is given twice")
        found[name] = value
    return found


def _value(name: str, value: Any, where: str) -> Any:
    if name not in _TYPES:
        raise InputError(where, f"no setting {name!r}, allowed are {', '.join(sorted(_TYPES))}")
    try:
        found = TypeAdapter(_TYPES[name]).validate_python(value)
    except ValidationError as error:
        raise InputError(where, f"{name}: {error.errors()[0]['msg']} (found {str(value)[:60]!r})") from None
    if isinstance(found, float) and not math.isfinite(found):
        raise InputError(where, f"{name}: must be finite (found {found})")
    if isinstance(found, int) and found > MAX_COUNT:
        raise InputError(where, f"{name}: must be at most {MAX_COUNT} (found {value!s:.60})")
    return found
