"""Messages of a bad link: in order, each once, with gaps and jumps of the clock told."""

import numpy as np
import pytest

from hydrolek_drake.watching.live.merging import Break, Merger, Row

INTERVAL = 0.01


def _row(value):
    return np.full((1, 4), float(value))


def _fed(merger, times, arrivals=None):
    found = []
    for i, time in enumerate(times):
        arrival = None if arrivals is None else float(arrivals[i])
        found += merger.push(float(time), _row(time), arrival)
    return found


def _times(items):
    return [item.time for item in items if isinstance(item, Row)]


def _breaks(items):
    return [item for item in items if isinstance(item, Break)]


def test_lost_doubled_and_late_messages_come_out_in_order_and_once():
    rng = np.random.default_rng(1)
    time = INTERVAL * np.arange(4000)
    keep = np.flatnonzero(rng.random(time.size) >= 0.05)
    sent = np.concatenate([keep, keep[rng.random(keep.size) < 0.05]])
    arrival = time[sent] + np.where(rng.random(sent.size) < 0.05, rng.uniform(0.0, 0.2, sent.size), 0.0)
    by = np.argsort(arrival, kind="stable")
    merger = Merger(INTERVAL)
    found = _fed(merger, time[sent][by], arrival[by]) + merger.flush()
    assert not _breaks(found)
    assert _times(found) == time[keep].tolist()
    assert [item.values[0, 0] for item in found] == time[keep].tolist()
    counts = merger.counts
    assert counts.doubled == sent.size - keep.size and counts.taken == keep.size
    assert counts.lost == keep[-1] - keep[0] + 1 - keep.size
    assert counts.late > 0 and counts.too_late == counts.astray == 0


@pytest.mark.parametrize(
    ("leap", "passed", "kind"),
    [(30.0, 30.0, "gap"), (30.0, 0.01, "clock ahead"), (30.0, None, "gap"), (-30.0, 0.01, "clock back")],
)
def test_a_gap_is_told_from_a_jump_by_when_messages_come(leap, passed, kind):
    before = 100.0 + INTERVAL * np.arange(200)
    after = before[-1] + leap + INTERVAL * np.arange(200)
    arrivals = None
    if passed is not None:
        arrivals = np.concatenate([before, before[-1] + passed + INTERVAL * np.arange(200)])
    merger = Merger(INTERVAL)
    found = _fed(merger, np.concatenate([before, after]), arrivals) + merger.flush()
    [broken] = _breaks(found)
    assert (broken.kind, broken.at, broken.to) == (kind, before[-1], after[0])
    assert _times(found) == [*before.tolist(), *after.tolist()]
    place = found.index(broken)
    assert found[place - 1].time == before[-1] and found[place + 1].time == after[0]


def test_single_messages_from_nowhere_move_nothing():
    time = INTERVAL * np.arange(1000)
    strange = {300: 1e9, 500: -5.0, 700: float("nan"), 800: 7.0}
    sent = [t for i, t in enumerate(time) for t in ([strange[i], t] if i in strange else [t])]
    merger = Merger(INTERVAL)
    found = _fed(merger, sent) + merger.flush()
    assert _times(found) == time.tolist() and not _breaks(found)
    counts = merger.counts
    assert (counts.astray, counts.too_late, counts.no_time, counts.doubled) == (1, 1, 1, 1)


def test_two_messages_of_one_time_are_one_sample():
    merger = Merger(INTERVAL)
    half, other = np.full((1, 4), np.nan), np.full((1, 4), np.nan)
    half[0, :2], other[0, 2:] = 1.0, 2.0
    assert merger.push(0.0, half) == [] and merger.push(0.0, other) == []
    [row] = merger.flush()
    assert row.values.tolist() == [[1.0, 1.0, 2.0, 2.0]] and merger.counts.doubled == 0


def test_a_new_recording_may_begin_at_any_time():
    merger = Merger(INTERVAL)
    first = _fed(merger, 50.0 + INTERVAL * np.arange(100))
    between = merger.begin()
    second = _fed(merger, INTERVAL * np.arange(100)) + merger.flush()
    assert len(_times(first + between)) == 100 and len(_times(second)) == 100
    assert [each.kind for each in _breaks(first + between + second)] == ["new recording"]


def test_nothing_grows_while_messages_pass():
    merger = Merger(INTERVAL)
    for part in range(20):
        _fed(merger, INTERVAL * np.arange(1000 * part, 1000 * (part + 1)))
        assert len(merger._pending) == len(merger._rows) <= 26 and len(merger._recent) <= 100
