"""The symbolic part of plans as PDDL: a domain, a problem for the scene, and the plan's actions.

The domain is that of the planner's logic: the agent picks an object with an empty hand, and places it on a surface,
which is the goal or the floor. Where exactly things are is geometry, which PDDL does not see; the plan says it in
comments. Requirements are `:strips` and `:typing`, so every planner and validator reads the files.
"""

from converter.formats.safe_names import safe_names
from converter.plan import Plan
from converter.replay import Step, replay
from converter.scene import Scene
from converter.shape import FloatArray, rounded
from pcg.errors import InputError

GOAL = "goal"
FLOOR = "floor"

DOMAIN = """\
(define (domain manipulation-puzzle)
  (:requirements :strips :typing)
  (:types movable surface)
  (:predicates
    (on ?o - movable ?s - surface)
    (holding ?o - movable)
    (hand-empty))
  (:action pick
    :parameters (?o - movable ?s - surface)
    :precondition (and (hand-empty) (on ?o ?s))
    :effect (and (holding ?o) (not (hand-empty)) (not (on ?o ?s))))
  (:action place
    :parameters (?o - movable ?s - surface)
    :precondition (holding ?o)
    :effect (and (hand-empty) (on ?o ?s) (not (holding ?o)))))
"""

_RESERVED = (
    *(GOAL, FLOOR, "pick", "place", "on", "holding", "hand-empty", "movable", "surface", "object"),
    *("and", "or", "not", "when", "forall", "exists", "define", "domain", "problem", "either"),
)


def problem_text(scene: Scene) -> str:
    """The problem of a scene: where its objects are, and that the goal-object has to lie on the goal."""
    names = _names(scene)
    surfaces = [_surface(scene, body.position) for body in scene.objects]
    lying = "\n".join(f"    (on {name} {surface})" for name, surface in zip(names, surfaces, strict=True))
    goal_object = names[scene.object_names.index(scene.goal.object)]
    (problem,) = safe_names([scene.name], _RESERVED)
    return f"""\
(define (problem {problem.lower().replace(".", "-")})
  (:domain manipulation-puzzle)
  (:objects {" ".join(names)} - movable {GOAL} {FLOOR} - surface)
  (:init
    (hand-empty)
{lying})
  (:goal (and (on {goal_object} {GOAL}) (hand-empty))))
"""


def plan_text(scene: Scene, plan: Plan) -> str:
    """The actions of a solved plan, one a line, with the places in comments.

    Raises:
        InputError: the plan has no solution, or carries an object that the scene does not have.
    """
    if not plan.solved:
        raise InputError(f"plan for {plan.scene!r}", f"status: {plan.status}; only a solved plan has actions")
    names = _names(scene)
    actions = [line for step in replay(scene, plan) for line in _actions(scene, step, names)]
    return "\n".join([*actions, f"; cost = {len(actions)} (unit cost)"]) + "\n"


def _actions(scene: Scene, step: Step, names: list[str]) -> list[str]:
    if step.carried is None:
        return []
    lines = []
    for action, positions in (("pick", step.positions), ("place", step.end_positions)):
        place = positions[step.carried]
        x, y = rounded(place, 9).tolist()
        lines.append(f"({action} {names[step.carried]} {_surface(scene, place)}) ; at {x} {y}")
    return lines


def _surface(scene: Scene, place: FloatArray) -> str:
    return GOAL if scene.goal.contains(place[:2]) else FLOOR


def _names(scene: Scene) -> list[str]:
    # PDDL ignores case and knows no dots.
    return [name.lower() for name in safe_names([name.replace(".", "-") for name in scene.object_names], _RESERVED)]
