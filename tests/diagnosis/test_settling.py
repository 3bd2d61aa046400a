"""Joints that move together: a fit is gone on with until what the joints do to each other has settled."""

from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis import weighing
from hydrolek_drake.diagnosis.effort import AT_NOISE


class _Bench:
    """Fits that leave one value after the other; training data are named by the round that weighed them."""

    together = True
    fine = 5e-4

    def __init__(self, leaves):
        self.leaves = list(leaves)
        self.recorded = self.training = ("as recorded",)
        self.starts = []

    def refit(self, hypothesis, step, most_steps):
        return _left(self.leaves.pop(0))

    def fit(self, effects, start, step, most_steps):
        self.starts.append((start, self.training))
        return _left(self.leaves.pop(0))


def _left(over_noise, **values):
    return SimpleNamespace(fit=SimpleNamespace(over_noise=over_noise), effects=(), values=values)


@pytest.fixture(autouse=True)
def rounds(monkeypatch):
    """What was weighed, in its order."""
    told = []

    def weighted(bench, hypothesis, experiments):
        told.append(hypothesis.fit.over_noise)
        return [f"told by {hypothesis.fit.over_noise}"]

    monkeypatch.setattr(weighing, "weighted_by", weighted)
    return told


def test_a_round_that_leads_away_does_not_end_it_and_the_best_one_counts(rounds) -> None:
    bench = _Bench([1.06, 1.07, 1.03, 1.031, 1.029])  # the last two take less than a tenth of 0.03
    best = weighing.settled(bench, _left(1.18))
    assert best.fit.over_noise == 1.029
    assert rounds == [1.18, 1.06, 1.07, 1.03, 1.031]
    assert bench.training == ("told by 1.031",)  # by which the best one was fitted
    assert not bench.leaves


def test_at_the_noise_it_ends(rounds) -> None:
    bench = _Bench([1.06, AT_NOISE, 0.9])
    assert weighing.settled(bench, _left(1.3)).fit.over_noise == AT_NOISE
    assert bench.leaves == [0.9]


def test_rounds_have_a_limit(rounds) -> None:
    bench = _Bench([1.0 + 2.0 * 0.8**n for n in range(20)])
    weighing.settled(bench, _left(2.9))
    assert len(rounds) == weighing.MOST_ROUNDS


@pytest.mark.parametrize(("anew", "wanted"), [([1.5, 1.05, 1.01], 1.01), ([2.0, 1.4, 1.39, 1.38], 1.08)])
def test_where_it_stays_above_the_noise_it_begins_anew_and_the_better_one_counts(anew, wanted) -> None:
    path = "joints.one.effects.supply.pressure_droop.size"
    bench = _Bench([1.08, 1.11, 1.10, *anew])
    stuck = _left(1.1, **{path: 3e9, "joints.one.valve.overlap_a": 1e-4})
    bench.refit = lambda h, step, most, refit=bench.refit: _with(refit(h, step, most), stuck.values)
    best = weighing._settled_or_anew(bench, stuck)
    assert best.fit.over_noise == wanted
    # from the rig's own numbers, with what the measured angles tell of the other joints
    assert bench.starts == [({path: 3e9}, ("as recorded",))]
    assert bench.training == (("told by 1.05",) if wanted == 1.01 else ("told by 1.1",))


def _with(hypothesis, values):
    hypothesis.values = values
    return hypothesis
