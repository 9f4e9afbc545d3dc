"""Short identities of plain documents."""

import hashlib
import json


def digest(document: object) -> str:
    """Sixteen hexadecimal digits over plain values, whatever the order of their keys."""
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:16]
