"""Last numbers: at the deepest local minimum near, and with intervals that reach as far as the likelihood."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar
from scipy.stats import chi2

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.intervals.curvature import NORMAL, intervals_of
from hydrolek_drake.diagnosis.intervals.last_numbers import LastNumbers, with_last_numbers
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

ALLOWED = float(chi2.ppf(0.95, 1))
OWN, SIZE = "joints.one.load.inertia", "joints.one.effects.some.effect.size"


class Drawn:
    """Residuals of a nominal parameter and an effect's size: one grows along a curve of the size, the other with both.

    The first ones are those of the curve at the size, the last one is 40 times what the nominal parameter and the size
    differ by: held to any size, the nominal parameter follows and leaves the curve alone.
    """

    evaluations, counted, unsure, admitted, longest_step = 0, 16, 0.0, 0.0, 5e-4
    experiments = ()  # curvature alone: of no recording there are blocks
    parameters = SimpleNamespace(
        paths=[OWN, SIZE],
        free=[
            SimpleNamespace(path=OWN, from_unit=lambda u: u),
            SimpleNamespace(path=SIZE, from_unit=lambda u: 10.0 * u),
        ],
        values=lambda unit: {OWN: float(unit[0]), SIZE: 10.0 * float(unit[1])},
        records=lambda unit: np.zeros(0),
    )

    def __init__(self, curve: Callable[[float], ArrayLike]) -> None:
        self._curve = curve

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        self.evaluations += 1
        return np.append(self._curve(float(unit[1])), 40.0 * (unit[0] - unit[1]))

    def jacobian_without_jumps(self, unit: np.ndarray, at: np.ndarray, moving: np.ndarray) -> np.ndarray:
        steps = np.eye(2) * 1e-7
        return np.stack([(self.residuals(unit + step) - at) / 1e-7 for step in steps], axis=1) * moving

    jacobian = jacobian_without_jumps

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        return np.zeros(2)

    def prior_jacobian(self) -> np.ndarray:
        return np.zeros((2, 2))


def _numbers(curve: Callable[[float], ArrayLike], begun: float):
    """Fit and intervals of a drawn problem, begun at a size between 0 and 1."""
    bench = SimpleNamespace(
        training=(),
        step_for=lambda effects, coarse=1.0: coarse * 5e-4,
        fine=5e-4,
        together=False,
        evaluations=0,
        interrupted=lambda: False,
        movable=lambda effects, parameters: np.ones(2, dtype=bool),
        problem=lambda *given, **named: Drawn(curve),
        side_by_side=lambda work, items: [work(item) for item in items],
    )
    effect = SimpleNamespace(free=[SimpleNamespace(path=SIZE)])
    unit = np.array([begun, begun])
    hypothesis = SimpleNamespace(effects=(effect,), step=5e-4, fit=SimpleNamespace(unit=unit))
    return LastNumbers(bench, hypothesis).found()


def test_a_straight_line_has_the_interval_of_its_slope() -> None:
    found, known = _numbers(lambda u: 20.0 * (u - 0.5), 0.52)
    assert found.values[SIZE] == pytest.approx(5.0, abs=0.05)  # a tenth of a square is 0.16 of a unit
    # the sum of squares is 2 residuals with 20 and 40: half of the interval is 1.96 / 20 of the range
    half = 10.0 * NORMAL / 20.0
    assert known[SIZE].high - known[SIZE].value == pytest.approx(half, rel=0.05)
    assert known[SIZE].value - known[SIZE].low == pytest.approx(half, rel=0.05)


def test_an_interval_reaches_as_far_as_the_likelihood_where_slopes_grow_flat() -> None:
    def flatter(u: float) -> float:
        return 20.0 * (u - 0.5) if u <= 0.5 else 20.0 * (np.sqrt(0.25 + (u - 0.5)) - 0.5)

    _, known = _numbers(flatter, 0.5)
    by_slope = 10.0 * NORMAL / 20.0
    below = known[SIZE].value - known[SIZE].low
    above = known[SIZE].high - known[SIZE].value
    wanted = 10.0 * (
        (np.sqrt(ALLOWED) / 20.0 + 0.5) ** 2 - 0.25
    )  # where the curve has fallen by what is allowed
    assert below == pytest.approx(by_slope, rel=0.02)
    assert above == pytest.approx(wanted, rel=0.02)
    assert above > 1.05 * by_slope


def test_an_end_that_the_likelihood_never_reaches_is_the_ranges() -> None:
    _, known = _numbers(lambda u: 20.0 * min(u - 0.5, 0.05), 0.5)
    assert known[SIZE].high == pytest.approx(10.0)
    assert known[SIZE].low == pytest.approx(10.0 * (0.5 - NORMAL / 20.0), abs=0.05)


def test_a_deeper_local_minimum_beside_is_where_it_ends() -> None:
    def two_minima(u: float) -> np.ndarray:
        return np.array([15.0 * (u - 0.42), 3.0 - 2.0 * np.exp(-(((u - 0.55) / 0.04) ** 2))])

    def squares(u: float) -> float:
        return float(two_minima(u) @ two_minima(u))

    bottom = minimize_scalar(squares, bounds=(0.5, 0.6), method="bounded")
    assert squares(0.42) > bottom.fun + 4.0
    found, known = _numbers(two_minima, 0.42)
    assert found.fit.objective == pytest.approx(bottom.fun, abs=0.2)
    assert found.values[SIZE] == pytest.approx(10.0 * bottom.x, abs=0.1)
    assert found.values[OWN] == pytest.approx(bottom.x, abs=0.01)
    assert known[SIZE].low < known[SIZE].value == found.values[SIZE] < known[SIZE].high


@pytest.mark.parametrize(
    ("effect", "size"),
    [
        ("amplifier.gain_fade", {"fraction": 0.08, "time_constant_s": 4.0}),
        ("linkage.backlash", {"gap_rad": 0.01}),
    ],
)
@pytest.mark.thorough(but=1)
def test_numbers_of_a_fit_that_ended_early_are_told_within_their_intervals(
    bench, recorded, fitted, effect, size
) -> None:
    machine = bench.with_values({f"effects.{effect}.{name}": value for name, value in size.items()})
    training, ahead = (recorded(machine, bench, seed=seed, largest_V=5.0) for seed in (3, 4))
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", training))
    concealed = next(c for c in candidates if c.id == effect)
    start = {f"{concealed.path}.{name}": 1.03 * value for name, value in size.items()}
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
        early = fitted(workbench, (concealed,), start, rounds=3, coarse=0.5)
        counted = sum(experiment.counted for experiment in ahead)
        told, known, held_out = with_last_numbers(workbench, Judged(early, np.zeros(1), counted), ahead)
        by_slopes = intervals_of(workbench.parameters((concealed,)), told.hypothesis.fit)
    assert (
        told.hypothesis.fit.objective <= early.fit.objective + EVIDENCE.lower
    )  # of data without the step's error
    assert told.over_noise == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * counted))
    assert list(held_out) == list(ahead)
    for name, value in size.items():
        path = f"{concealed.path}.{name}"
        assert known[path].low <= value <= known[path].high
        assert known[path].low <= by_slopes[path].low and by_slopes[path].high <= known[path].high
        assert known[path].high - known[path].low < 0.5 * value


def test_the_step_of_the_integration_bends_no_number(bench, recorded, fitted) -> None:
    """Air in the oil and quiet pressure sensors: fitted with a step eight times as long as the recording was made."""
    air = 0.03
    machine = bench.with_values({"effects.fluid.entrained_air.air_fraction": air})
    training = [
        replace(each, longest_step=8e-4)
        for each in recorded(machine, bench, seed=5, noise_deg=0.01, pressure_noise_Pa=3e3)
    ]
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", training))
    concealed = next(c for c in candidates if c.id == "fluid.entrained_air")
    path = f"{concealed.path}.air_fraction"
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
        with_step_error = fitted(workbench, (concealed,), {path: air}, rounds=20, coarse=0.5)
        found, known = LastNumbers(workbench, with_step_error).found()
    deviation = (known[path].high - known[path].low) / (2.0 * NORMAL)
    assert abs(with_step_error.values[path] - air) > 3.0 * deviation
    assert abs(found.values[path] - air) < 2.0 * deviation
