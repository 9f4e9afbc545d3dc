from itertools import islice

import numpy as np
import pytest

from evaluate.expressive_range import expressive_range_figure
from pcg.generate import random_levels
from pcg.level_set import manifest_entry

ENTRIES = [manifest_entry(generated) for generated in islice(random_levels(2), 12)]


@pytest.mark.parametrize("sets", [1, 4, 6])
def test_a_panel_for_each_level_set(sets: int):
    """Panels have their names, common axes and a histogram whose shares add up to one."""
    figure = expressive_range_figure({f"set {k}": ENTRIES[: 12 - k] for k in range(sets)})
    panels = [ax for ax in figure.axes if ax.get_title()]
    assert [ax.get_title() for ax in panels] == [f"set {k} ({12 - k})" for k in range(sets)]
    assert len({ax.get_xlim() for ax in panels}) == len({ax.get_ylim() for ax in panels}) == 1
    for ax in panels:
        shares = ax.collections[0].get_array()
        assert shares is not None
        assert np.ma.filled(shares, 0.0).sum() == pytest.approx(1)


def test_every_level_is_inside():
    """The axes reach beyond the most walls and the most pushes."""
    (panel, *_) = expressive_range_figure({"set": ENTRIES}).axes
    assert max(entry.statistics.walls for entry in ENTRIES) < panel.get_xlim()[1]
    assert max(entry.pushes or 0 for entry in ENTRIES) < panel.get_ylim()[1]
