"""From pydantic's list of errors to the one line that a user can act on."""

import math
import reprlib
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError

from pcg.errors import InputError

Model = TypeVar("Model", bound=BaseModel)


class Document(BaseModel):
    """Base of every file model: no unknown fields, no NaN or infinity, immutable."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


MAX_DEPTH = 20
"""Deepest nesting of lists and mappings."""


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    _require_plain(values, 0)
    return values


def _require_plain(value: Any, depth: int) -> None:
    if depth > MAX_DEPTH:
        raise ValueError(f"nested deeper than {MAX_DEPTH} levels")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"every number must be finite, found {value}")
    if isinstance(value, str):
        _require_unicode(value)
    items = [*value, *value.values()] if isinstance(value, dict) else value if isinstance(value, list) else ()
    for item in items:
        _require_plain(item, depth + 1)


def _require_unicode(text: str) -> str:
    """Refuses what JSON can say and files cannot hold: halves of characters."""
    if not text.isascii() and any("\ud800" <= character <= "\udfff" for character in text):
        raise ValueError(f"text must be Unicode, found {text[:60]!r}")
    return text


PlainText = Annotated[str, AfterValidator(_require_unicode)]
"""Text that every file can hold."""

PlainValues = Annotated[dict[str, Any], AfterValidator(_plain)]
"""Values that every file can hold: text, finite numbers, and lists and mappings of them."""


def validated(model: type[Model], data: Any, where: str) -> Model:
    """`data` as a `model`.

    Args:
        model: What the document has to be.
        data: Plain values as a parser returns them.
        where: What `data` was read from, a file's path as a rule; it begins the message.

    Raises:
        InputError: naming the first field that does not fit, what was found and what is allowed.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first, count = error.errors(include_url=False)[0], error.error_count()
        place = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in first["loc"]).lstrip(".")
        found = "" if first["type"] == "missing" else f" (found {_shortened(first['input'])})"
        more = f"; {count - 1} more problem{'s' if count > 2 else ''}" if count > 1 else ""
        message = _PLAIN.get(first["type"], first["msg"].removeprefix("Value error, "))
        problem = f"{place or 'document'}: {message}{found}{more}"
        raise InputError(where, problem) from None


_PLAIN = {
    "missing": "is missing",
    "extra_forbidden": "there is no such field",
    "tuple_type": "must be a list",
    "list_type": "must be a list",
    "dict_type": "must be a mapping",
    "model_type": "must be a mapping",
    "model_attributes_type": "must be a mapping",
    "float_type": "must be a number",
}
"""Words for those of pydantic's errors that speak of Python; by the type of the error."""


def _shortened(value: Any, length: int = 60) -> str:
    text = " ".join(_REPR.repr(value).split())
    return text if len(text) <= length else text[: length - 1] + "…"


_REPR = reprlib.Repr()
"""What a value may be is anybody's guess: a million lists, or a thousand in each other."""
_REPR.maxstring = _REPR.maxlong = _REPR.maxother = 200
_REPR.maxlist = _REPR.maxtuple = _REPR.maxdict = 20
_REPR.maxlevel = 4
