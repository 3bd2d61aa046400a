"""Joints that move together: parameters are fitted with what the joints do to each other."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis import settling, weighing
from hydrolek_drake.diagnosis.settling import corrected
from hydrolek_drake.identification.least_squares import Fit

NAMES = ("a", "b", "c", "d")
TRUTH = np.array([0.3, 0.6, 0.45, 0.7])
NOISE = 1e-3


class _Bench:
    """Residuals own (u - truth) + others (told - truth) over the noise: `told` is what the Diagram was asked with."""

    together, fine = True, 5e-4

    def __init__(self, start: np.ndarray):
        rng = np.random.default_rng(3)
        self.own = rng.standard_normal((40, 4))
        round_and_round = np.kron(np.eye(2), [[0.0, -1.1], [1.1, 0.0]])  # turns lead ever farther away
        self.others = self.own @ round_and_round + 0.3 * rng.standard_normal((40, 4))
        self.recorded = self.training = (start,)
        self.rig = SimpleNamespace(with_values=lambda values: np.array([values[n] for n in NAMES]))
        self.noise = NOISE * rng.standard_normal(40)

    def parameters(self, effects):
        return SimpleNamespace(values=lambda unit: dict(zip(NAMES, unit, strict=True)))

    def movable(self, effects, parameters):
        return np.ones(4, dtype=bool)

    def alive(self):
        pass

    def fit(self, effects, values, step, most_steps):
        unit = np.array([values[n] for n in NAMES])
        if most_steps > 1:  # of its own rollouts, with the others as told: to the end
            known = self.others @ (self.training[0] - TRUTH) + self.noise
            unit = TRUTH - np.linalg.lstsq(self.own, known, rcond=None)[0]
        left = self.own @ (unit - TRUTH) + self.others @ (self.training[0] - TRUTH) + self.noise
        fit = Fit(unit, left / NOISE, np.zeros(4), self.own / NOISE, np.zeros((4, 4)), 40, 1)
        return SimpleNamespace(effects=effects, values=dict(zip(NAMES, unit, strict=True)), fit=fit)

    def refit(self, hypothesis, step, most_steps):
        return self.fit(hypothesis.effects, hypothesis.values, step, most_steps)


@pytest.fixture(autouse=True)
def diagram(monkeypatch):
    """The Diagram tells what the others do with the values that it is asked with."""

    monkeypatch.setattr(settling, "felt_together", lambda rig, experiments: [rig])


def test_it_ends_where_turns_with_the_diagram_do_not() -> None:
    start = TRUTH + 0.02
    bench = _Bench(start)
    turns = bench.fit((), dict(zip(NAMES, start, strict=True)), bench.fine, 1)
    for _ in range(20):
        bench.training = (turns.fit.unit,)
        turns = bench.refit(turns, bench.fine, 30)
    bench.training = (turns.fit.unit,)
    assert bench.refit(turns, bench.fine, 1).fit.over_noise > 10.0

    bench.training = (start,)
    begun = bench.fit((), dict(zip(NAMES, start, strict=True)), bench.fine, 1)
    found = settling.settled_together(bench, begun)
    least = np.linalg.lstsq(bench.own + bench.others, bench.noise, rcond=None)[1]
    assert found.fit.chi_squared == pytest.approx(least[0] / NOISE**2, rel=1e-3)
    assert found.fit.unit == pytest.approx(TRUTH, abs=2.0 * NOISE)
    assert bench.training[0] == pytest.approx(found.fit.unit, abs=1e-12)  # told by the place that counts


def test_the_best_place_counts_and_not_the_last(monkeypatch) -> None:
    bench = _Bench(TRUTH + 0.02)
    begun = bench.fit((), dict(zip(NAMES, TRUTH + 0.02, strict=True)), bench.fine, 1)
    monkeypatch.setattr(settling, "damped_step", lambda best, jacobian, moving, damping: np.full(4, 0.05))
    found = settling.settled_together(bench, begun)
    assert found.fit.unit == pytest.approx(TRUTH + 0.02)
    assert bench.training[0] == pytest.approx(TRUTH + 0.02)


def test_a_corrected_jacobian_agrees_with_every_way_and_is_left_alone_across_them() -> None:
    rng = np.random.default_rng(1)
    jacobian, ways, changes = rng.normal(size=(7, 4)), rng.normal(size=(2, 4)), rng.normal(size=(2, 7))
    told = corrected(jacobian, list(ways), list(changes))
    for way, change in zip(ways, changes, strict=True):
        assert told @ way == pytest.approx(change)
    across = np.linalg.svd(ways)[2][2:]
    assert told @ across.T == pytest.approx(jacobian @ across.T)
    assert corrected(jacobian, [], []) is jacobian


@pytest.mark.parametrize("effects", [("droop",), ("droop", "friction")])
@pytest.mark.parametrize(("leaves", "wanted"), [((1.01,), 1.01), ((1.08, 1.05), 1.05), ((1.08, 1.38), 1.08)])
def test_a_fit_settles_as_it_is_or_from_the_rigs_own_values_and_the_better_one_counts(
    effects, leaves, wanted, monkeypatch
) -> None:
    path = "joints.one.effects.supply.pressure_droop.size"
    bent = SimpleNamespace(effects=effects, values={path: 3e9, "joints.one.valve.overlap_a": 1e-4})
    bench = SimpleNamespace(training=("weighed",), recorded=("as recorded",), fine=5e-4)
    begun, left = [], list(leaves)

    def settles(bench, hypothesis):
        begun.append((hypothesis.values, bench.training))
        bench.training = (f"told with {left[0]}",)
        return SimpleNamespace(values=hypothesis.values, fit=SimpleNamespace(over_noise=left.pop(0)))

    monkeypatch.setattr(weighing, "settled", settles)
    bench.fit = lambda effects, start, step, most_steps: SimpleNamespace(effects=effects, values=start)
    assert weighing._settled_or_anew(bench, bent).fit.over_noise == wanted
    assert bench.training == (f"told with {wanted}",)
    as_it_is, anew = (bent.values, ("weighed",)), ({path: 3e9}, ("as recorded",))
    order = [anew, as_it_is] if len(effects) == 1 else [as_it_is, anew]
    assert begun == order[: len(leaves)]
