"""`manipuzzle space`: the configuration spaces of a scene at its start, as a picture."""

import numpy as np

from converter.drawing import Rounded
from converter.render_space import Space, spaces_drawing
from converter.shape import FloatArray
from converter.theme import theme_named
from evaluate.commands.options import Json, ObjectName, Out, SceneFile, Still, Theme, application
from evaluate.inputs import read_scene_file, require_choice, require_writable
from evaluate.names import safe_name
from evaluate.output import print_json, print_line
from evaluate.picture_files import require_still, write_drawing
from planner.configuration_space import ConfigurationSpace
from planner.contact_curve import ContactCurve
from planner.problem import Problem
from planner.visibility import ShortestPathTree

app = application()

WIDTH_PX = 1200
"""Width of the picture."""

CURVE_POINTS = 256
"""Points that stand for the whole contact curve in the picture."""


@app.command()
def run(
    scene: SceneFile,
    *,
    out: Out,
    object_: ObjectName = None,
    format_: Still = "png",
    theme: Theme = "paper",
    json: Json = False,
) -> bool:
    """Draw the configuration spaces at the start: of the agent alone, and of the agent while it holds an object.

    Grey: where its centre may not be. Thin lines: the shortest paths from where it is to every corner of free space.
    Left, around the object: the contact curve, green where there are grasps. Right: the reachable
    grasp with the shortest way to the centre of the goal, or the first one. Exit status 1 if none can be reached.

    Example:  manipuzzle space data/puzzles/wall.yaml --out out/pictures
    """
    require_still(format_)
    colors = theme_named(theme)
    start = read_scene_file(scene)
    name = start.goal.object if object_ is None else object_
    require_choice("--object", name, start.object_names)
    problem, index = Problem(start), start.object_names.index(name)
    driving, grasps = driving_space(problem, index)
    spaces = [driving, *([] if len(grasps) == 0 else [carrying_space(problem, index, grasps)])]
    require_writable(out)
    file = out / f"{safe_name(start.name)}-{safe_name(name)}-space.{format_}"
    write_drawing(file, spaces_drawing(start, spaces, theme=colors), WIDTH_PX, f"configuration spaces of {start.name}")
    arrives = len(spaces) > 1 and spaces[1].path is not None
    if json:
        print_json(
            {"scene": start.name, "object": name, "stretches": len(grasps), "arrives": arrives, "file": str(file)}
        )
    else:
        print_line(f"{start.name}: {len(grasps)} reachable stretches of grasps of {name}; picture in {file}")
    return len(grasps) > 0


def driving_space(problem: Problem, index: int) -> tuple[Space, FloatArray]:
    """Where the agent can drive, with the contact curve of object `index`.

    Returns:
        The panel, and the middle (k, 2) [m] of each free stretch that can be reached, relative to the object.
    """
    scene, at = problem.scene, problem.initial.objects[index]
    body, agent = scene.objects[index], problem.initial.agent
    space = problem.agent_space(problem.initial)
    tree = ShortestPathTree(space, agent)
    curve = ContactCurve(body, scene.agent.radius)
    stretches = curve.free_stretches(problem.grasp_obstacles(problem.initial, index))
    grasps = curve.at(stretches.mean(axis=1))
    reached = tree.reaches(at + grasps)
    free = [at + curve.at(np.linspace(start, end, CURVE_POINTS)) for start, end in stretches]
    whole = at + curve.at(np.linspace(0, curve.length, CURVE_POINTS))
    panel = Space("the agent alone", rounded(space), tree.edges, free, [whole], None, agent)
    return panel, grasps[reached]


def carrying_space(problem: Problem, index: int, grasps: FloatArray) -> Space:
    """Where the agent can go with object `index`: in the grasp that allows the shortest way to the goal, or the first.

    Args:
        problem: The problem.
        index: The object.
        grasps: (k, 2) [m] agent centre minus object position, k >= 1.
    """
    scene, at = problem.scene, problem.initial.objects[index]
    name, spaces = scene.object_names[index], problem.carry_spaces(problem.initial, index)
    trees = [ShortestPathTree(spaces(grasp), at + grasp) for grasp in grasps]
    paths = [
        tree.path_to(scene.goal.position + grasp) if index == problem.goal_index else None
        for tree, grasp in zip(trees, grasps, strict=True)
    ]
    lengths = [np.inf if path is None else float(np.hypot(*np.diff(path, axis=0).T).sum()) for path in paths]
    best = int(np.argmin(lengths))
    tree, title = trees[best], f"the agent with {name} in one grasp"
    return Space(title, rounded(tree.space), tree.edges, (), (), paths[best], at + grasps[best], name)


def rounded(space: ConfigurationSpace) -> tuple[Rounded, ...]:
    """The obstacles of a space as shapes."""
    obstacles = space.obstacles
    vertices = np.split(obstacles.vertices, obstacles.first[1:-1])
    return tuple(Rounded(polygon, max(0.0, float(r))) for polygon, r in zip(vertices, obstacles.rho, strict=True))
