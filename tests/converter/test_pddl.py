import re
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.formats.pddl import DOMAIN, plan_text, problem_text
from converter.plan import Plan, Segment, Status
from converter.scene import Goal, Scene
from pcg.errors import InputError

Expression: TypeAlias = Any
Atom: TypeAlias = tuple[str, ...]
PDDL_NAME = re.compile(r"[a-z][a-z0-9_-]*")


def parsed(text: str) -> list[Expression]:
    """The expressions of a PDDL text as nested lists, lower case, without comments."""
    stack: list[list[Expression]] = [[]]
    for token in re.findall(r"[()]|[^\s()]+", re.sub(r";[^\n]*", "", text).lower()):
        if token == "(":  # noqa: S105  # no password
            stack.append([])
        elif token == ")":  # noqa: S105  # no password
            stack[-2].append(stack.pop())
        else:
            stack[-1].append(token)
    assert len(stack) == 1
    return stack[0]


def typed(words: list[str]) -> dict[str, str]:
    """Types by name, of a list such as `a b - t c - u`."""
    types: dict[str, str] = {}
    names: list[str] = []
    rest = iter(words)
    for word in rest:
        if word == "-":
            kind = next(rest)
            types.update(dict.fromkeys(names, kind))
            names = []
        else:
            names.append(word)
    assert not names
    return types


def literals(condition: Expression) -> list[Expression]:
    """The members of a conjunction."""
    return condition[1:] if condition[0] == "and" else [condition]


@dataclass
class Interpreter:
    """A small one of typed STRIPS, written from the definition of PDDL: states are sets of atoms."""

    domain: list[Expression]
    problem: list[Expression]

    def section(self, of: list[Expression], name: str) -> Expression:
        """The part of a definition that begins with `name`."""
        (found,) = [part for part in of if isinstance(part, list) and part[0] == name]
        return found[1:]

    def run(self, plan: str) -> set[Atom]:
        """The state after the actions of a plan; fails if one is not applicable."""
        objects = typed(self.section(self.problem, ":objects"))
        assert all(PDDL_NAME.fullmatch(name) for name in objects)
        assert set(objects.values()) <= set(self.section(self.domain, ":types"))
        predicates = {p[0]: typed(p[1:]) for p in self.section(self.domain, ":predicates")}
        state = {tuple(atom) for atom in self.section(self.problem, ":init")}
        for atom in state:
            assert [objects[name] for name in atom[1:]] == list(predicates[atom[0]].values())
        actions = {part[1]: part for part in self.domain if isinstance(part, list) and part[0] == ":action"}
        for name, *arguments in parsed(plan):
            body = dict(zip(actions[name][2::2], actions[name][3::2], strict=True))
            parameters = typed(body[":parameters"])
            assert [objects[argument] for argument in arguments] == list(parameters.values())
            binding = dict(zip(parameters, arguments, strict=True))
            for atom in literals(body[":precondition"]):
                assert bound(atom, binding) in state, f"{name} {arguments}: {atom} does not hold"
            removed = {bound(e[1], binding) for e in literals(body[":effect"]) if e[0] == "not"}
            state = state - removed | {bound(e, binding) for e in literals(body[":effect"]) if e[0] != "not"}
        return state

    @property
    def goal(self) -> set[Atom]:
        """The atoms that have to hold at the end."""
        (condition,) = self.section(self.problem, ":goal")
        return {tuple(atom) for atom in literals(condition)}


def bound(atom: list[str], binding: dict[str, str]) -> Atom:
    """An atom with its variables replaced."""
    return tuple(binding.get(word, word) for word in atom)


def interpreter(scene: Scene) -> Interpreter:
    """Of the domain and the scene's problem."""
    (domain,), (problem,) = parsed(DOMAIN), parsed(problem_text(scene))
    assert domain[:2] == ["define", ["domain", "manipulation-puzzle"]]
    assert problem[0] == "define"
    assert [":domain", "manipulation-puzzle"] in problem
    return Interpreter(domain, problem)


def test_a_plan_is_valid_and_reaches_the_goal(small_room: Scene, small_plan: Plan):
    """Each action is applicable, and the goal holds at the end."""
    made = interpreter(small_room)
    assert made.goal <= made.run(plan_text(small_room, small_plan))


def test_the_plan_in_full(small_room: Scene, small_plan: Plan):
    """Carries become a pick and a placement each, with places in comments."""
    assert plan_text(small_room, small_plan) == (
        "(pick obj floor) ; at -1.0 0.0\n"
        "(place obj floor) ; at -1.2 0.8\n"
        "(pick obj floor) ; at -1.2 0.8\n"
        "(place obj goal) ; at -1.0 1.5\n"
        "; cost = 4 (unit cost)\n"
    )


def test_a_plan_that_ends_elsewhere_does_not_reach_the_goal(small_room: Scene, small_plan: Plan):
    """Surfaces come from geometry, not from the plan's claim."""
    made = interpreter(small_room)
    assert not made.goal <= made.run(plan_text(small_room, replace(small_plan, segments=small_plan.segments[:2])))


def test_what_lies_in_the_goal_at_the_start_is_on_it(small_room: Scene):
    """Also another object than the goal-object."""
    scene = replace(small_room, goal=Goal("obj", np.array([0.0, 1.0]), np.array([0.5, 0.5])))
    assert "(on obstacle goal)" in problem_text(scene)
    assert "(on obj floor)" in problem_text(scene)


@settings(max_examples=20)
@given(scene=..., rounds=st.lists(st.integers(0, 1), max_size=4))
def test_any_scene_has_a_valid_problem(scene: Scene, rounds: list[int]):
    """Whatever the names are, and whatever is carried."""
    names = [scene.object_names[index % len(scene.objects)] for index in rounds]
    segments = tuple(Segment("carry", name, np.array([[0.0, 0.0], [0.5, 0.1]])) for name in names)
    plan = Plan(scene.name, scene.geometry_hash, "by hand", 0, Status.SOLVED, 0.0, 0.0, segments=segments)
    final = interpreter(scene).run(plan_text(scene, plan))
    assert len(final) == len(scene.objects) + 1


def test_only_solved_plans_have_actions(small_room: Scene, small_plan: Plan):
    """The status is named."""
    with pytest.raises(InputError, match="status: timeout"):
        plan_text(small_room, replace(small_plan, status=Status.TIMEOUT, segments=()))
