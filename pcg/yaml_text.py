"""YAML text to plain values and back: what a scene file needs and nothing that can surprise.

Read are mappings, lists, strings, numbers, true/false and null by the rules of YAML 1.2, so `1e-3` is a number while
`on` and `2024-01-01` are text. Anchors, aliases, tags and repeated keys are errors; nesting and size are bounded, so a
small file cannot unfold into a large one.
"""

import re
from typing import Any

import yaml

from pcg.errors import InputError
from pcg.validation import MAX_DEPTH

MAX_VALUES = 500_000
"""Keys and values of a document, lists and mappings counting twice; each takes some hundred bytes to read."""

WIDTH = 120
"""Longest line that is written where it can be broken."""

try:
    from yaml import CSafeDumper as _BaseDumper
    from yaml import CSafeLoader as _BaseLoader
except ImportError:  # PyYAML was built without libyaml
    from yaml import SafeDumper as _BaseDumper  # type: ignore[assignment]  # same interface, but slower
    from yaml import SafeLoader as _BaseLoader  # type: ignore[assignment]  # same interface, but slower

_INT = re.compile(r"^[-+]?[0-9]{1,18}$")
_FLOAT = re.compile(r"^(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf)|\.(?:nan|NaN))$")
_RESOLVERS = (
    ("null", re.compile(r"^(?:~|null|Null|NULL|)$"), ["~", "n", "N", ""]),
    ("bool", re.compile(r"^(?:true|True|TRUE|false|False|FALSE)$"), list("tTfF")),
    ("int", _INT, list("-+0123456789")),
    ("float", _FLOAT, list("-+.0123456789")),
)


class Flow(dict[str, Any]):
    """A mapping that is written on one line: `{name: wall, position: [0.0, 1.0, 0.2]}`."""


class _Loader(_BaseLoader):
    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012  # overrides PyYAML's class attribute

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:  # noqa: FBT001, FBT002  # PyYAML's signature
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(None, None, "a key must be plain text", key.start_mark)
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"{key.value!r} is given twice", key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


class _Dumper(_BaseDumper):
    def ignore_aliases(self, _data: Any) -> bool:
        return True


for _tag, _pattern, _first in _RESOLVERS:
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", _pattern, _first)
# A leading zero means octal to PyYAML's own constructor.
_Loader.add_constructor("tag:yaml.org,2002:int", lambda _, node: int(node.value))
# Beside PyYAML's own rules, so that text like `1e-3` is quoted by a reader of either version of YAML.
_Dumper.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+.0123456789"))
_Dumper.add_representer(
    Flow, lambda dumper, data: dumper.represent_mapping("tag:yaml.org,2002:map", data, flow_style=True)
)
# Text of several lines, such as a level, is written line by line.
_Dumper.add_representer(
    str,
    lambda dumper, text: dumper.represent_scalar("tag:yaml.org,2002:str", text, style="|" if "\n" in text else None),
)


def parse(text: str, where: str) -> Any:
    """The plain values of a YAML document.

    Args:
        text: One YAML document.
        where: What it was read from; it begins the message.

    Raises:
        InputError: naming the line.
    """
    try:
        _require_plain(text, where)
        return yaml.load(text, Loader=_Loader)  # noqa: S506  # a safe loader, with fewer types than the standard one
    except yaml.MarkedYAMLError as error:
        line = _line(error.problem_mark or error.context_mark)
        raise InputError(f"{where}, line {line}", f"not a YAML file: {error.problem or error.context}") from None
    except yaml.YAMLError as error:
        raise InputError(where, f"not a YAML file: {' '.join(str(error).split())}") from None


def dump(document: dict[str, Any]) -> str:
    """The text of plain values; lists of numbers and `Flow` mappings stay on one line, text keeps its lines."""
    return yaml.dump(
        document, Dumper=_Dumper, default_flow_style=None, sort_keys=False, width=WIDTH, allow_unicode=True
    )


def _line(mark: Any) -> int:
    return 1 if mark is None else mark.line + 1


def _require_plain(text: str, where: str) -> None:
    depth = 0
    for count, event in enumerate(yaml.parse(text, Loader=_Loader)):
        if count > MAX_VALUES:
            problem = f"more than {MAX_VALUES} values"
        elif isinstance(event, yaml.NodeEvent) and event.anchor is not None:
            problem = "anchors and aliases are not allowed"
        elif isinstance(event, (yaml.ScalarEvent, yaml.CollectionStartEvent)) and event.tag is not None:
            problem = f"tags are not allowed, found {event.tag}"
        elif depth > MAX_DEPTH:
            problem = f"nested deeper than {MAX_DEPTH} levels"
        else:
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            continue
        raise InputError(f"{where}, line {_line(event.start_mark)}", problem)
