from evaluate.bench_generator import environment_contests
from pcg.representation import REPRESENTATIONS


def test_every_representation_is_timed_in_both_regimes():
    """In batches and one by one, with any seed; shares of cache hits and of changed maps stand beside the times."""
    contests = list(environment_contests(2))
    assert len(contests) == 4 * len(REPRESENTATIONS)
    assert len({contest.name for contest in contests}) == len(contests)
    for contest in contests:
        contest.work(1)
        assert contest.figures is not None
        figures = contest.figures()
        assert figures.keys() == {"cache_hits", "maps_changed"}
        assert 0 <= figures["cache_hits"] < 0.6
        assert 0.2 < figures["maps_changed"] < 1
