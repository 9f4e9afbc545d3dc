"""Documents in a database: JSON compressed by zlib."""

import json
import zlib
from typing import Any

from pcg import json_text
from pcg.errors import InputError

MAX_BYTES = 20_000_000
"""Of a document that is not compressed; a small blob may unfold into a thousand times its size."""


def packed(document: dict[str, Any]) -> bytes:
    """The bytes of an object of plain values."""
    return zlib.compress(json.dumps(document).encode())


def unpacked(blob: bytes, where: str) -> dict[str, Any]:
    """The object of `packed`; `where` begins the message.

    Raises:
        InputError: the bytes are damaged, hold something else, or unfold into more than `MAX_BYTES`.
    """
    unpacker = zlib.decompressobj()
    try:
        text = unpacker.decompress(blob, MAX_BYTES)
    except zlib.error as error:
        raise InputError(where, f"what is stored is damaged: {error}") from None
    if not (unpacker.eof or unpacker.unconsumed_tail):
        raise InputError(where, "what is stored is damaged: it ends too early")
    if unpacker.unconsumed_tail:
        raise InputError(where, f"what is stored is larger than {MAX_BYTES / 1e6:g} MB")
    stored = f"{where}: what is stored"
    return json_text.require_object(json_text.parse(text, stored), stored)
