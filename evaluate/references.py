"""Other people's functions, named in a study: `module:function`, or an entry point of an installed package."""

import functools
import importlib
import importlib.metadata
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, cast

from pcg.errors import InputError

PLANNERS, SUBGOALS, HEURISTICS = "manipuzzle.planners", "manipuzzle.subgoals", "manipuzzle.heuristics"
"""Groups of entry points."""


@dataclass(frozen=True)
class Reference:
    """A function that is imported where it is used, so that it can be named in a file and sent to other machines.

    Attributes:
        text: `module:function`, where the function may be any callable and `a.b` an attribute of an attribute; or the
            name of an entry point.
        group: The group of that entry point.
        folder: Where modules are looked for after Python's own search path: beside the file that names them. It does
            not tell references apart.
    """

    text: str
    group: str
    folder: str | None = field(default=None, compare=False)

    def load(self) -> Callable[..., Any]:
        """The function.

        Raises:
            InputError: it cannot be imported, or is nothing that can be called.
        """
        return _loaded(self.text, self.group, self.folder)


@functools.cache
def _loaded(text: str, group: str, folder: str | None) -> Callable[..., Any]:
    if folder is not None and folder not in sys.path:
        sys.path.append(folder)
    try:
        function = _imported(text) if ":" in text else _entry_point(text, group)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001  # whatever somebody else's module raises
        raise InputError(text, f"cannot be imported: {type(error).__name__}: {error}") from None
    if not callable(function):
        raise InputError(text, f"found a {type(function).__name__}, allowed is something that can be called")
    return cast("Callable[..., Any]", function)


def _imported(text: str) -> Any:
    module, _, path = text.partition(":")
    return functools.reduce(getattr, path.split("."), importlib.import_module(module))


def _entry_point(name: str, group: str) -> Any:
    found = importlib.metadata.entry_points(group=group)
    if name not in found.names:
        known = ", ".join(sorted(found.names)) or "none is installed"
        raise InputError(name, f"neither module:function nor an entry point of {group} ({known})")
    return found[name].load()
