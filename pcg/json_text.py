"""JSON text to plain values, with errors that name their place."""

import json
from typing import Any

from pcg.errors import InputError


def parse(text: str | bytes, where: str) -> Any:
    """The plain values of a JSON document.

    Args:
        text: The document; bytes are UTF-8.
        where: What it was read from; it begins the message.

    Raises:
        InputError: it is no JSON, or nested so deeply that it cannot be read.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise InputError(where, "not a JSON document that can be read: nested too deeply") from None
    except ValueError as error:
        raise InputError(where, f"not a JSON document: {error}") from None


def require_object(value: Any, where: str) -> dict[str, Any]:
    """The value, if it is a JSON object.

    Raises:
        InputError: it is something else.
    """
    if not isinstance(value, dict):
        raise InputError(where, f"a JSON object wanted, found a {type(value).__name__}")
    return value
