from pathlib import Path

import pytest

from pcg.agents import agent_named, policy_path, read_agents
from pcg.errors import InputError

HEAD = "format: 1\nrows: 10\ncolumns: 10\ncrates: 2\ntargets: 1\nagents:\n"
LINE = "  - {name: m0, representation: wide, wall_density: [0.1, 0.2], pushes: [3, 6]}\n"


def test_the_agents_of_the_product():
    """36 agents: every representation with every band of walls and of pushes, numbered in order."""
    agents = read_agents()
    assert list(agents) == [f"m{k}" for k in range(36)]
    kinds = [(a.representation, a.request.wall_density, a.request.pushes) for a in agents.values()]
    assert len(set(kinds)) == 36
    assert [len(set(values)) for values in zip(*kinds, strict=True)] == [3, 4, 3]
    for agent in agents.values():
        assert (agent.request.rows, agent.request.columns, agent.request.crates, agent.request.targets) == (
            10,
            10,
            2,
            1,
        )


def test_the_bands_cover_the_published_scenes_without_overlap():
    """Walls 7 to 26 and pushes 3 to 19, each number in one band."""
    requests = [agent.request for agent in read_agents().values()]
    walls = {(round(100 * low), round(100 * high)) for low, high in (r.wall_density for r in requests)}
    pushes = {r.pushes for r in requests}
    for bands, low, high in ((walls, 7, 26), (pushes, 3, 19)):
        covered = sorted(value for first, last in bands for value in range(first, last + 1))
        assert covered == list(range(low, high + 1))


def test_agents_are_found_by_name():
    """An unknown name is answered by those that there are."""
    assert agent_named("m35").representation == "wide"
    assert policy_path("wide").name == "wide.onnx"
    with pytest.raises(InputError, match=r"--agent: found 'm36', allowed are random, m0 \.\.\. m35"):
        agent_named("m36")


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "document: "),
        (HEAD + LINE + LINE, "the agent m0 is given twice"),
        (HEAD + LINE.replace("wide", "deep"), "agents[0].representation: "),
        (HEAD + LINE.replace("0.2]", "0.05]"), "agents[0].wall_density: the first end of a band"),
        (HEAD + LINE.replace("[3, 6]", "[3, 6.5]"), "agents[0].pushes[1]: "),
        (HEAD + LINE.replace("m0", "x"), "agents[0].name: "),
        (HEAD.replace("crates: 2", "crates: 0") + LINE, "crates: "),
        (HEAD.replace("targets: 1", "targets: 3") + LINE, "agent m0: 2 crates cannot cover 3 targets"),
        (HEAD.replace("format: 1", "format: 2") + LINE, "format: "),
        (HEAD + LINE.replace("}", ", speed: 1}"), "agents[0].speed: "),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, problem: str):
    """One line with file, field and reason."""
    path = tmp_path / "agents.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_agents(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert problem in str(caught.value)
