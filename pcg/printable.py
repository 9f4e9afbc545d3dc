"""Text from files and names, made harmless for a terminal and for one line."""

MAX_LENGTH = 1_000
"""Characters of a message; of longer ones the middle is left out."""


def one_line(text: str, length: int = MAX_LENGTH) -> str:
    r"""`text` as one line of printable characters; of more than `length` the middle is left out.

    Space of any kind becomes one blank. What cannot be printed becomes its escape sequence, such as `\x1b`, so that no
    name moves the cursor, changes colours or reverses the direction of writing; a sequence counts as one character.
    """
    if len(text) > length:
        half = length // 2
        text = f"{text[:half]}…{text[1 - length + half :]}"
    return printable(" ".join(text.split()))


def printable(text: str) -> str:
    """`text` with escape sequences instead of what cannot be printed; blanks stay."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
