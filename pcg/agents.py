"""The agents: which policy is asked for what.

`data/agents.yaml` lists them: a representation, a band of wall density, a band of pushes. The random baseline is no
agent of that file: it takes any request.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from pcg.data_folder import data_folder
from pcg.errors import InputError
from pcg.files import read_text
from pcg.representation import REPRESENTATIONS
from pcg.request import Request
from pcg.validation import Document, validated
from pcg.yaml_text import parse

AGENTS_FILE = "agents.yaml"
POLICIES_FOLDER = "policies"


@dataclass(frozen=True)
class Agent:
    """A policy and what it is asked for.

    Attributes:
        name: `m0`, `m1` and so on.
        representation: How the policy edits levels: narrow, turtle or wide.
        request: What its levels have to be.
    """

    name: str
    representation: str
    request: Request


def read_agents(path: Path | None = None) -> dict[str, Agent]:
    """The agents by name, in the order of the file.

    Args:
        path: The file; None for the one that comes with the product.

    Raises:
        InputError: naming file, field and reason.
    """
    path = data_folder() / AGENTS_FILE if path is None else path
    document = validated(_Agents, parse(read_text(path), str(path)), str(path))
    return {entry.name: _agent(entry, document, path) for entry in document.agents}


def agent_named(name: str) -> Agent:
    """The agent of that name.

    Raises:
        InputError: there is none; names those that there are.
    """
    agents = read_agents()
    if name not in agents:
        first, *_, last = agents
        raise InputError(
            "--agent",
            f"found {name!r}, allowed are random, {first} ... {last}, {', '.join(REPRESENTATIONS)}, FILE.onnx",
        )
    return agents[name]


def policy_path(representation: str) -> Path:
    """The weights of the policy of a representation."""
    return data_folder() / POLICIES_FOLDER / f"{representation}.onnx"


def _ascending(band: tuple[float, float]) -> tuple[float, float]:
    if band[0] > band[1]:
        raise ValueError("the first end of a band must not exceed the second")
    return band


class _Agent(Document):
    name: Annotated[str, Field(pattern=r"^m(0|[1-9][0-9]{0,3})$")]
    representation: Literal["narrow", "turtle", "wide"]
    wall_density: Annotated[
        tuple[Annotated[float, Field(ge=0, le=1)], Annotated[float, Field(ge=0, le=1)]], AfterValidator(_ascending)
    ]
    pushes: Annotated[
        tuple[Annotated[int, Field(ge=0, le=1000)], Annotated[int, Field(ge=0, le=1000)]], AfterValidator(_ascending)
    ]


class _Agents(Document):
    format: Literal[1]
    rows: Annotated[int, Field(ge=1, le=100)]
    columns: Annotated[int, Field(ge=1, le=100)]
    crates: Annotated[int, Field(ge=1, le=100)]
    targets: Annotated[int, Field(ge=1, le=100)]
    agents: Annotated[list[_Agent], Field(min_length=1, max_length=1000)]

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        names = [agent.name for agent in self.agents]
        if repeated := sorted({name for name in names if names.count(name) > 1}):
            raise ValueError(f"the agent {repeated[0]} is given twice")
        return self


def _agent(entry: _Agent, document: _Agents, path: Path) -> Agent:
    try:
        request = Request(
            rows=document.rows,
            columns=document.columns,
            crates=document.crates,
            targets=document.targets,
            wall_density=entry.wall_density,
            pushes=entry.pushes,
        )
    except ValueError as error:
        raise InputError(str(path), f"agent {entry.name}: {error}") from None
    return Agent(entry.name, entry.representation, request)
