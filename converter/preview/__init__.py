"""The physics preview: scenes in a 2D physics engine (pymunk), seen from above.

`check_scene` decides whether a scene can be set up and begun. `drive` follows a path with a disc that is only told how
fast to go, and reports what it touches and pushes; `play_back` follows a plan and reports what moves that should not.
Where to drive is for the caller to say.
"""

from converter.preview.checks import Problem, ProblemKind, SceneCheck, check_scene
from converter.preview.driving import Drive, drive
from converter.preview.playback import Playback, PlaybackProblem, PlaybackProblemKind, play_back
from converter.preview.simulation import Moved, Touch
from converter.preview.world import ENGINE_SLACK

__all__ = [
    "ENGINE_SLACK",
    "Drive",
    "Moved",
    "Playback",
    "PlaybackProblem",
    "PlaybackProblemKind",
    "Problem",
    "ProblemKind",
    "SceneCheck",
    "Touch",
    "check_scene",
    "drive",
    "play_back",
]
