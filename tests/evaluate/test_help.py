"""What `--help` says: every command shows an example, and every argument and option says what it is for."""

from collections.abc import Iterator
from importlib import import_module
from typing import Any

import pytest
import typer

from evaluate.cli import COMMANDS

LEAST_WORDS = 3
"""Of an option's text; the metavar says the rest."""


def commands() -> Iterator[tuple[str, Any]]:
    """Every command that runs, with its full name."""
    for name in COMMANDS:
        module = import_module(f"evaluate.commands.{name.replace('-', '_')}")
        yield from _leaves(name, typer.main.get_command(module.app))


def _leaves(name: str, command: Any) -> Iterator[tuple[str, Any]]:
    inner = getattr(command, "commands", None)
    if inner is None:
        yield name, command
        return
    for each, sub in inner.items():
        yield from _leaves(f"{name} {each}", sub)


ALL = dict(commands())


def test_there_are_commands_of_both_kinds():
    """The list is not empty, and holds commands of commands."""
    assert {"solve", "corpus build", "space"} <= ALL.keys()


@pytest.mark.parametrize("name", ALL)
def test_help_shows_an_example(name: str):
    """One that names the command itself."""
    assert f"Example:  manipuzzle {name}" in (ALL[name].help or "")


@pytest.mark.parametrize("name", ALL)
def test_every_parameter_is_explained(name: str):
    """By a sentence of some words that ends with a full stop; a metavar tells what to write."""
    for parameter in ALL[name].params:
        if parameter.name == "help":
            continue
        text = parameter.help or ""
        assert len(text.split()) >= LEAST_WORDS, parameter.name
        assert text.endswith("."), parameter.name
