"""Profile likelihood: closed forms of a linear model, a side that is open, and a parameter of the bench."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.least_squares.profile import profile

BENCH = Path(__file__).parents[2] / "data" / "bench" / "practice_01"


class Linear:
    """Residuals y - A u with unit noise."""

    def __init__(self, matrix, measured):
        self.matrix, self.measured = matrix, measured
        self.evaluations, self.counted, self.unsure, self.admitted = 0, len(measured), 0.0, 0.0

    def residuals(self, unit):
        self.evaluations += 1
        return self.measured - self.matrix @ unit

    def jacobian(self, unit, at=None, moving=None):
        return -self.matrix

    def leading_slopes(self, unit, at, moving=None):
        return None

    def prior_residuals(self, unit):
        return np.zeros(0)

    def prior_jacobian(self):
        return np.zeros((0, self.matrix.shape[1]))


def _linear(correlated=0.0):
    rng = np.random.default_rng(4)
    matrix = rng.standard_normal((200, 3)) * 8.0
    matrix[:, 1] += correlated * matrix[:, 0]
    true = np.array([0.4, 0.5, 0.6])
    problem = Linear(matrix, matrix @ true + 0.9 * rng.standard_normal(200))
    covariance = np.linalg.inv(matrix.T @ matrix)
    return problem, covariance @ matrix.T @ problem.measured, np.sqrt(np.diag(covariance))


@pytest.mark.parametrize("correlated", [0.0, 3.0])
@pytest.mark.parametrize("index", [0, 1, 2])
def test_profile_of_a_linear_model_is_a_parabola_and_its_interval_that_of_the_standard_error(
    correlated, index
):
    problem, best, deviation = _linear(correlated)
    scale = max(float(np.mean(problem.residuals(best) ** 2)), 1.0)
    found = profile(problem, best, index, deviation[index])
    np.testing.assert_allclose(
        found.growth, (found.places - best[index]) ** 2 / deviation[index] ** 2 / scale, atol=1e-4
    )
    half = norm.ppf(0.975) * deviation[index] * np.sqrt(scale)
    assert found.low == pytest.approx(best[index] - half, abs=1e-3 * half)
    assert found.high == pytest.approx(best[index] + half, abs=1e-3 * half)
    assert found.improved < 1e-6


def test_a_misfit_beyond_the_noise_widens_the_interval():
    problem, best, deviation = _linear()
    narrow = profile(problem, best, 0, deviation[0])
    problem.measured = problem.measured + 5.0 * np.random.default_rng(5).standard_normal(200)
    best = np.linalg.lstsq(problem.matrix, problem.measured, rcond=None)[0]
    misfit = np.sqrt(np.mean(problem.residuals(best) ** 2))
    wide = profile(problem, best, 0, deviation[0])
    assert misfit > 4.0
    assert (wide.high - wide.low) == pytest.approx(misfit * (narrow.high - narrow.low), rel=0.01)


def test_a_parameter_that_another_makes_up_for_is_not_bounded():
    rng = np.random.default_rng(6)
    column = rng.standard_normal(100)
    problem = Linear(np.column_stack([column, column]), column + rng.standard_normal(100) * 0.1)
    found = profile(problem, np.array([0.5, 0.5]), 0, np.inf)
    assert found.low is None and found.high is None
    assert found.places[0] == 0.0 and found.places[-1] == 1.0


def test_what_is_known_beforehand_counts_as_a_measured_value_does():
    problem, best, deviation = _linear()
    known = Linear(problem.matrix, problem.measured)
    weight = 1.0 / deviation[0]  # known beforehand as well as by measurement
    known.prior_residuals = lambda unit: np.array([weight * (unit[0] - best[0])])
    known.prior_jacobian = lambda: np.array([[weight, 0.0, 0.0]])
    narrow, wide = (profile(p, best, 0, deviation[0]) for p in (known, problem))
    assert narrow.high - narrow.low == pytest.approx((wide.high - wide.low) / np.sqrt(2.0), rel=1e-3)


def test_others_that_are_led_along_the_tangents_of_a_linear_model_leave_the_same_curve():
    problem, best, deviation = _linear(3.0)
    covariance = np.linalg.inv(problem.matrix.T @ problem.matrix)

    def others(start):
        there = best + (start[0] - best[0]) * covariance[:, 0] / covariance[0, 0]
        left = problem.residuals(there)
        return there, float(left @ left)

    by_fits = profile(problem, best, 0, deviation[0])
    led = profile(problem, best, 0, deviation[0], first=2.0, others=others)
    assert (led.low, led.high) == pytest.approx((by_fits.low, by_fits.high), abs=1e-4 * deviation[0])
    assert len(led.places) == 3 < len(by_fits.places)  # one beyond the threshold on either side
    assert led.lowest == pytest.approx(best)


def test_a_start_beside_the_optimum_is_said():
    problem, best, deviation = _linear()
    found = profile(problem, best + np.array([3.0, 0.0, 0.0]) * deviation, 0, deviation[0])
    assert found.improved == pytest.approx(9.0, rel=0.1)
    assert found.lowest == pytest.approx(best, abs=deviation.max())


def test_profile_on_the_bench_by_command_agrees_with_its_standard_error(tmp_path, capsys):
    labels = json.loads((BENCH.parent / "practice_labels.json").read_text())
    machine = next(label["machine"] for label in labels if label["id"] == BENCH.name)
    known = {
        "valve.overlap_a": "x_o_m",
        "valve.full_opening_a": "w_m",
        "supply.pressure": "P_S_Pa",
        "fluid.bulk_modulus": "B_Pa",
        "cylinder.viscous_friction": "c_cyl_N_s_per_m",
        "load.gravity_cos": "mgl_Nm",
        "amplifier.max_current_a": "I_max_A",
    }
    searched = ["command.delay", "valve.max_area_a", "load.inertia"]
    arguments = [
        *(text for path in searched for text in ("--parameter", path)),
        *(text for path, key in known.items() for text in ("--set", f"{path}={machine[key]}")),
        *("--profile", "command.delay", "--no-confirm", "--out", str(tmp_path)),
    ]
    assert run(["fit", "joint_bench", str(BENCH / "train.csv"), *arguments]) == 0
    assert "profile likelihood, 95 %" in capsys.readouterr().out
    (row,) = json.loads((tmp_path / "profiles.json").read_text())
    fit = json.loads((tmp_path / "fit.json").read_text())
    standard = fit["parameters"]["joints.joint.command.delay"]
    assert fit["over_noise"] < 1.05
    assert row["low"] < row["fitted"] < row["high"]
    # of three parameters with good data the curve is nearly the parabola of the standard error
    assert row["high"] - row["low"] == pytest.approx(standard["high"] - standard["low"], rel=0.25)
    assert row["low"] < machine["T_d_s"] < row["high"]
    assert (tmp_path / "profiles.png").read_bytes().startswith(b"\x89PNG")


def test_a_profile_of_what_is_not_fitted_is_refused(capsys):
    status = run(
        [
            "fit",
            "joint_bench",
            str(BENCH / "train.csv"),
            "--parameter",
            "load.inertia",
            "--profile",
            "command.delay",
        ]
    )
    error = capsys.readouterr().err
    assert (
        status == 2 and "is not fitted; choose joints.joint.load.inertia" in error and error.count("\n") == 1
    )
