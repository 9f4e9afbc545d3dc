"""What a study consists of, as its folder remembers it."""

from dataclasses import dataclass
from functools import cached_property

from evaluate.trial_row import TrialRow


@dataclass(frozen=True)
class StudyRecord:
    """What the study consists of that last ran in a folder; the folder may hold trials of other studies too.

    Attributes:
        name: Title of the study.
        scenes: Name and `Scene.geometry_hash` of each scene, in order. A name may occur once per geometry preset.
        methods: Name and `Method.hash` of each method, in order.
        seeds: The seeds.
        trials: Number of trials; less than the product of the three where a method does not suit a scene. Of merged
            folders it is the number of trials that they hold.
    """

    name: str
    scenes: tuple[tuple[str, str], ...]
    methods: tuple[tuple[str, str], ...]
    seeds: tuple[int, ...]
    trials: int

    def includes(self, row: TrialRow) -> bool:
        """Whether a row is a trial of the study."""
        scenes, methods, seeds = self._sets
        return (
            (row.scene, row.scene_hash) in scenes and (row.method, row.settings_hash) in methods and row.seed in seeds
        )

    @cached_property
    def _sets(self) -> tuple[frozenset[tuple[str, str]], frozenset[tuple[str, str]], frozenset[int]]:
        return frozenset(self.scenes), frozenset(self.methods), frozenset(self.seeds)
