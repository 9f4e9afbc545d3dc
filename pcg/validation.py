"""From pydantic's list of errors to the one line that a user can act on."""

from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from pcg.errors import InputError

Model = TypeVar("Model", bound=BaseModel)


class Document(BaseModel):
    """Base of every file model: no unknown fields, no NaN or infinity, immutable."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


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
        more = f"; {count - 1} more" if count > 1 else ""
        problem = f"{place or 'document'}: {first['msg'].removeprefix('Value error, ')}{found}{more}"
        raise InputError(where, problem) from None


def _shortened(value: Any, length: int = 60) -> str:
    text = " ".join(repr(value)[: 4 * length].split())
    return text if len(text) <= length else text[: length - 1] + "…"
