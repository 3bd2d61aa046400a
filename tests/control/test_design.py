"""Gains by LQ and pole placement: Tables 6.5, 6.6 and 6.8 to four decimals, and the properties of a design."""

import control
import numpy as np
import pytest

from hydrolek_drake.control.design import (
    TransferFunction,
    closed_loop_poles,
    closed_loop_polynomial,
    forward_path,
    integrator,
    lq_gains,
    nonminimal_state_space,
    pole_gains,
)
from hydrolek_drake.control.thesis_gains import entry, gains_data, pip_gains
from hydrolek_drake.errors import InputError

JOINTS = ("j1", "j2", "j3", "j4")
TABLES = ("pip_no_scaling", "pip_scaled", "pip_idz.a", "pip_idz.b", "pip_idz.c")
DELAYS = gains_data()["control"]["delay_samples"]
FORWARD_DELAYS = gains_data()["control"]["delay_samples_forward"]
FOUR_DECIMALS = 0.5e-4 + 1e-9


def _designed(found, delay):
    """Gains from the weights, or from what the data file says reproduces the printed ones."""
    by = found.get("reproduced_by", {})
    weights = by.get("weights", found["weights"])
    if "poles" in by:
        return pole_gains(integrator(delay), [complex(*pole) for pole in by["poles"]])
    return lq_gains(integrator(delay, found.get("b", 1.0)), *weights)


REPRODUCED = [
    (table, joint) for table in TABLES for joint in JOINTS if (table, joint) != ("pip_no_scaling", "j4")
]


@pytest.mark.parametrize(("table", "joint"), REPRODUCED)
def test_tables_6_5_and_6_6_to_four_decimals(table, joint):
    gains = _designed(entry(table, joint), DELAYS[joint])
    printed = pip_gains(table, joint)
    assert gains.f == pytest.approx(printed.f, abs=FOUR_DECIMALS)
    assert gains.g == pytest.approx(printed.g, abs=FOUR_DECIMALS)
    assert gains.k_i == pytest.approx(printed.k_i, abs=FOUR_DECIMALS)


def test_joint_4_without_scaling_prints_the_gains_of_a_delay_of_3_with_two_more():
    """f and the last two g belong to a delay of 3 samples; a delay of 5 gives all others."""
    found = entry("pip_no_scaling", "j4")
    short = lq_gains(integrator(found["reproduced_by"]["delay"], found["b"]), *found["weights"])
    assert short.f == pytest.approx(found["f"], abs=FOUR_DECIMALS)
    assert short.g == pytest.approx(found["g"][-2:], abs=FOUR_DECIMALS)
    assert short.k_i == pytest.approx(found["k_i"], abs=1e-4)
    right = lq_gains(integrator(DELAYS["j4"], found["b"]), *found["weights"])
    assert right.g[:2] == pytest.approx(found["g"][-2:], abs=FOUR_DECIMALS)


@pytest.mark.parametrize(
    ("table", "joint"), [("pip_idz.a", "j2"), ("pip_idz.c", "j1"), ("pip_no_scaling", "j4")]
)
def test_printed_weights_listed_as_misprints_do_not_give_the_printed_gains(table, joint):
    found = entry(table, joint)
    gains = lq_gains(integrator(DELAYS[joint], found["b"]), *found["weights"])
    assert abs(gains.f[0] - found["f"][0]) > 0.01


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("tuning", "abc")
def test_table_6_8_to_four_decimals(tuning, joint):
    found, delay = entry(f"pip_forward.{tuning}", joint), FORWARD_DELAYS[joint]
    num, den = forward_path(_designed(found, delay), integrator(delay - 1))
    assert num == pytest.approx(found["num"], abs=FOUR_DECIMALS)
    assert den == pytest.approx(found["den"], abs=FOUR_DECIMALS)


@pytest.mark.parametrize("table", TABLES)
def test_every_loop_of_the_thesis_is_stable_on_its_model(table):
    for joint in JOINTS:
        found = entry(table, joint)
        poles = closed_loop_poles(integrator(DELAYS[joint], found["b"]), pip_gains(table, joint))
        assert np.max(np.abs(poles)) < 1.0


MODELS = (integrator(3), integrator(1, 0.2), TransferFunction((-1.6, 0.64), (0.0, 0.5, 0.2)))


@pytest.mark.parametrize("model", MODELS)
def test_the_state_space_form_has_the_models_response(model):
    f, g, d, h = nonminimal_state_space(model)
    rng = np.random.default_rng(1)
    u, wanted = rng.standard_normal(60), rng.standard_normal(60)
    y, z = np.zeros(60), 0.0
    x = np.zeros((len(f), 1))
    for k in range(60):
        past = [y[k - i] if k >= i else 0.0 for i in range(1, len(model.a) + 1)]
        inputs = [u[k - i] if k >= i else 0.0 for i in range(1, len(model.b) + 1)]
        y[k] = -np.dot(model.a, past) + np.dot(model.b, inputs)
        z += wanted[k] - y[k]
        x = f @ x + g * inputs[0] + d * wanted[k]
        assert (h @ x).item() == pytest.approx(y[k], abs=1e-9)
        assert x[-1, 0] == pytest.approx(z, abs=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_lq_gains_beat_any_nearby_gains(model):
    """The optimum of the quadratic cost: every small change of a gain costs more."""
    weights = (0.5, 20.0, 1.0)
    gains = lq_gains(model, *weights)
    n, m = len(model.a), len(model.b)
    f, g, _, _ = nonminimal_state_space(model)
    q = np.diag([*[weights[2] / n] * n, *[weights[1] / m] * (m - 1), weights[0]])

    def cost(k):
        closed = f - g @ k
        return np.trace(control.dlyap(closed.T, q + k.T @ k * weights[1] / m))

    best = np.array([[*gains.f, *gains.g, -gains.k_i]])
    for i in range(best.shape[1]):
        for change in (-0.02, 0.02):
            other = best.copy()
            other[0, i] += change * abs(other[0, i])
            assert cost(other) > cost(best)


@pytest.mark.parametrize("model", MODELS)
def test_pole_placement_puts_the_poles_where_asked(model):
    order = len(model.a) + len(model.b)
    wanted = np.array([0.6 + 0.1j, 0.6 - 0.1j, 0.3, 0.2, 0.1][:order] if order > 1 else [0.5])
    gains = pole_gains(model, wanted)
    assert np.sort_complex(closed_loop_poles(model, gains)) == pytest.approx(
        np.sort_complex(np.concatenate([wanted, np.zeros(order - len(wanted))])), abs=1e-6
    )


@pytest.mark.parametrize("model", MODELS)
def test_the_closed_loop_polynomial_is_that_of_6_18(model):
    gains = lq_gains(model, 1.0, 10.0, 1.0)
    polynomial = closed_loop_polynomial(model, gains)
    from_poles = np.poly(closed_loop_poles(model, gains))
    length = max(len(polynomial), len(from_poles))
    padded = [np.pad(p, (0, length - len(p))) for p in (polynomial, from_poles)]
    assert padded[0] == pytest.approx(padded[1], abs=1e-9)


def test_6_18_as_printed_for_delay_3():
    f0, g1, g2, k_i, a1, b = 0.5, 0.4, 0.3, 0.1, -1.0, 1.0
    gains = pip_gains("pip_idz.a", "j1").__class__((f0,), (g1, g2), k_i)
    printed = [1.0, a1 + g1 - 1.0, a1 * g1 + g2 - a1 - g1, g1 - 2 * g2 + f0 + k_i, -(a1 * g2 + f0 * b)]
    assert closed_loop_polynomial(integrator(3), gains) == pytest.approx(printed)


def test_the_forward_path_of_an_integrator_has_no_integral_action():
    gains = lq_gains(integrator(3), 0.1, 1000.0, 10.0)
    num, den = forward_path(gains, integrator(2))
    assert sum(num) == pytest.approx(0.0, abs=1e-12)  # cancels the pole of the summed error
    assert sum(den) == pytest.approx(gains.f[0])  # so that the steady output is k_I / f0 times the error


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: lq_gains(integrator(3), 0.0, 1.0, 1.0), "must be above 0"),
        (lambda: pole_gains(integrator(2), [1.2]), "inside the unit circle"),
        (lambda: pole_gains(integrator(2), [0.5 + 0.2j]), "conjugate pairs"),
        (lambda: pole_gains(integrator(1), [0.1] * 5), "at most 2"),
        (lambda: pole_gains(TransferFunction((-1.0,), (1.0, -1.0)), [0.5]), "cannot be controlled"),
        (lambda: integrator(0), "at least 1"),
        (lambda: TransferFunction((-1.0,), (0.0, 0.0)), "one b that is not zero"),
    ],
)
def test_impossible_designs_are_refused_with_one_line(call, message):
    with pytest.raises(InputError, match=message):
        call()
