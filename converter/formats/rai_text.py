"""The text of `.g` files: a list of frames with a parent and attributes, as read by the authors' engine `rai`.

    Include 'walls.g'
    name (parent) { key:value, key=value  flag }

The reader is tolerant where the published files are loose: separators may be missing, `:` and `=` mean the same, a
stray closing bracket is skipped. Values stay uninterpreted here: a list of numbers, a pose in angle brackets, or text.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeAlias

from pcg.errors import InputError
from pcg.files import is_file, read_text

MAX_BYTES = 8_000_000
MAX_FRAMES = 10_000
MAX_TOKENS = 400_000
"""Words, numbers and marks of a file."""
MAX_NAME = 200
"""Characters of a name."""
MAX_FILES = 100

Value: TypeAlias = tuple[float, ...] | str
"""Finite numbers, or the text of a word, a string, a `{set}` or a `<pose>`."""

_TOKEN = re.compile(
    r"""(?P<skipped>[\s,;]+|\#[^\n]*)
      | (?P<string>'[^'\n]*'|"[^"\n]*")
      | (?P<pose><[^>\n]*>)
      | (?P<mark>[][(){}:=])
      | (?P<word>[^][(){}:=,;\s\#'"<>]+)
      | (?P<bad>.)""",
    re.VERBOSE,
)
_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?")
_CLOSING = {"[": "]", "(": ")", "{": "}"}


class Token(NamedTuple):
    """A piece of text and its place, `file, line n`."""

    kind: str
    text: str
    where: str


@dataclass(frozen=True)
class Frame:
    """A frame as written.

    Attributes:
        name: Unique.
        parent: Name of the parent, None for a root.
        attributes: Values by key; a flag without a value is `"1"`.
        where: File and line of the name.
        places: File and line of each attribute.
    """

    name: str
    parent: str | None
    attributes: Mapping[str, Value]
    where: str
    places: Mapping[str, str]

    def numbers(self, key: str, allowed: tuple[int, ...]) -> tuple[float, ...]:
        """The numbers of an attribute.

        Raises:
            InputError: the attribute is missing, is no list of numbers, or their count is not allowed.
        """
        if key not in self.attributes:
            raise InputError(self.where, f"{self.name}: {key} is missing")
        value = self.attributes[key]
        if isinstance(value, str) or len(value) not in allowed:
            counts = " or ".join(map(str, allowed))
            raise InputError(self.places[key], f"{self.name}: {key} needs {counts} numbers, found {_shown(value)}")
        return value


def read_frames(path: Path) -> dict[str, Frame]:
    """The frames of a `.g` file and of the files that it includes, by name, in order.

    Raises:
        InputError: naming file and line.
    """
    reader = _Reader()
    reader.read(path)
    return reader.frames


class _Reader:
    """What was read so far, over all included files."""

    def __init__(self) -> None:
        self.frames: dict[str, Frame] = {}
        self._files: set[Path] = set()

    def read(self, path: Path) -> None:
        self._files.add(path.resolve())
        tokens = _Tokens(path)
        while (token := tokens.next()) is not None:
            if token.text == "Include":
                self._include(path, *tokens.value(token))
            elif token.kind == "word":
                self._add(_frame(token, tokens))
            elif token.text not in _CLOSING.values():
                raise InputError(token.where, f"the name of a frame wanted, found {token.text!r}")

    def _include(self, path: Path, name: Value, where: str) -> None:
        if not isinstance(name, str):
            raise InputError(where, "Include needs the name of a file in quotes")
        included = path.parent / name
        if not is_file(included):
            raise InputError(where, f"the included file {name!r} does not exist beside this one")
        if included.resolve() in self._files:
            raise InputError(where, f"{name!r} is included twice, or includes itself")
        if len(self._files) == MAX_FILES:
            raise InputError(where, f"more than {MAX_FILES} files included")
        self.read(included)

    def _add(self, frame: Frame) -> None:
        if frame.name in self.frames:
            raise InputError(frame.where, f"frame {frame.name!r} was already given ({self.frames[frame.name].where})")
        if len(self.frames) == MAX_FRAMES:
            raise InputError(frame.where, f"more than {MAX_FRAMES} frames")
        self.frames[frame.name] = frame


def _frame(name: Token, tokens: "_Tokens") -> Frame:
    if len(name.text) > MAX_NAME:
        raise InputError(name.where, f"frame {name.text[:60]!r}…: a name has at most {MAX_NAME} characters")
    parent = None
    if tokens.peek() == "(":
        tokens.next()
        parent = " ".join(tokens.until(")", name)) or None
    if tokens.peek() == ":":
        tokens.next()
    if tokens.peek() != "{":
        raise InputError(name.where, f"frame {name.text!r}: `{{` wanted, found {tokens.peek()!r}")
    tokens.next()
    attributes: dict[str, Value] = {}
    places: dict[str, str] = {}
    while (token := tokens.next()) is not None and token.text != "}":
        if token.text == "]":
            continue
        if token.kind not in ("word", "string"):
            raise InputError(token.where, f"{name.text}: the name of an attribute wanted, found {token.text!r}")
        attributes[token.text], places[token.text] = _attribute(token, tokens)
    if token is None:
        raise InputError(name.where, f"frame {name.text!r}: the closing `}}` is missing")
    return Frame(name.text, parent, attributes, name.where, places)


def _attribute(key: Token, tokens: "_Tokens") -> tuple[Value, str]:
    return tokens.value(key) if tokens.peek() in (":", "=", "[") else ("1", key.where)


class _Tokens:
    """The tokens of one file, one ahead."""

    def __init__(self, path: Path) -> None:
        self._tokens = _tokens(read_text(path, MAX_BYTES), str(path))
        self._ahead = next(self._tokens, None)

    def peek(self) -> str | None:
        return None if self._ahead is None else self._ahead.text

    def next(self) -> Token | None:
        token, self._ahead = self._ahead, next(self._tokens, None)
        return token

    def until(self, closing: str, opening: Token) -> list[str]:
        texts: list[str] = []
        depth = 1
        while (token := self.next()) is not None:
            depth += (_CLOSING.get(token.text) == closing) - (token.text == closing)
            if depth == 0:
                return texts
            texts.append(token.text)
        raise InputError(opening.where, f"{opening.text!r}: the closing `{closing}` is missing")

    def value(self, key: Token) -> tuple[Value, str]:
        if self.peek() in (":", "="):
            self.next()
        token = self.next()
        if token is None or token.text in (*_CLOSING.values(), ":", "="):
            raise InputError(key.where, f"{key.text!r} has no value")
        if token.kind in ("string", "pose"):
            return token.text[1:-1], token.where
        if token.kind == "word":
            number = _number(token.text)
            return (token.text if number is None else (number,)), token.where
        items = self.until(_CLOSING[token.text], key)
        numbers = [_number(item) for item in items]
        if token.text == "[" and None not in numbers:
            return tuple(number for number in numbers if number is not None), token.where
        return " ".join(items), token.where


def _tokens(text: str, file: str) -> Iterator[Token]:
    line = 0
    where = f"{file}, line 1"
    for count, match in enumerate(_TOKEN.finditer(text)):
        kind, piece = match.lastgroup or "bad", match.group()
        if kind == "bad" or not (kind == "skipped" or piece.replace("\t", " ").isprintable()):
            raise InputError(where, f"unexpected {piece[:60]!r}")
        if count > MAX_TOKENS:
            raise InputError(where, f"more than {MAX_TOKENS} words and marks, the most that a file may have")
        if kind != "skipped":
            yield Token(kind, piece, where)
        elif lines := piece.count("\n"):
            line += lines
            where = f"{file}, line {line + 1}"


def _number(text: str) -> float | None:
    number = float(text) if _NUMBER.fullmatch(text) else math.inf
    return number if math.isfinite(number) else None


def _shown(value: Value) -> str:
    text = value if isinstance(value, str) else "[" + " ".join(f"{number:g}" for number in value) + "]"
    return repr(text[:60])
