from evaluate.bench_generator import environment_contests
from pcg.representation import REPRESENTATIONS


def test_every_representation_is_timed_in_both_regimes():
    """Six contests, each of which can be run with any seed."""
    contests = list(environment_contests(2))
    assert len(contests) == 2 * len(REPRESENTATIONS)
    for contest in contests:
        assert 0 <= contest.work(1) <= 1
