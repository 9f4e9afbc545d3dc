"""Where the carries of a plan leave their objects, for planners that do not say so."""

from dataclasses import replace

from converter.plan import Plan, Subgoal
from converter.replay import replay
from pcg.errors import InputError


def with_placements(plan: Plan) -> Plan:
    """The plan with the end of each carry as a subgoal, unless it has subgoals or carries unknown objects."""
    if plan.subgoals or plan.scene_data is None:
        return plan
    try:
        steps = replay(plan.scene_data, plan)
    except InputError:
        return plan
    carries = (step for step in steps if step.carried is not None and step.segment.object is not None)
    return replace(plan, subgoals=tuple(Subgoal(str(s.segment.object), s.end_positions[s.carried]) for s in carries))
