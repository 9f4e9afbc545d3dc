"""`manipuzzle check`: scenes in the physics preview."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from converter.preview import check_scene
from evaluate.inputs import read_scenes
from evaluate.output import print_json, print_line, print_table, progress


def run(paths: Sequence[Path], *, preset: str | None, tolerance: float | None, as_json: bool) -> bool:
    """Runs the command; see `evaluate.cli.check`."""
    scenes = read_scenes(paths, preset, tolerance)
    with progress() as bar:
        checks = [check_scene(scene) for scene in bar.track(scenes, description="scenes")]
    if as_json:
        print_json(
            {
                "scenes": [
                    {"scene": check.scene, "valid": check.valid, "problems": [asdict(p) for p in check.problems]}
                    for check in checks
                ]
            }
        )
    else:
        rows = [(c.scene, c.valid, "; ".join(p.message for p in c.problems)) for c in checks]
        print_table(["scene", "valid", "problems"], rows)
        print_line(f"{sum(check.valid for check in checks)} of {len(checks)} scenes are valid")
    return all(check.valid for check in checks)
