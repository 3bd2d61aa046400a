"""Constant speed of a cylinder between two series orifices, against the closed form."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

P_S, P_T = 4.4e6, 0.14e6
AREA_A, AREA_B = 201.06e-6, 122.52e-6
DISCHARGE, DENSITY = 0.7, 870.0


@pytest.mark.parametrize("viscous", [0.0, 833.0])
@pytest.mark.parametrize("load", [0.0, 150.0])
@pytest.mark.parametrize("voltage", [2.0, 4.0, -3.0])
def test_speed_at_a_constant_opening(slide, run, voltage, load, viscous):
    """A_feed P_feed - A_back P_back = F + c v with both orifices' square-root laws.

    v^2 (A_feed^3 + A_back^3)/K^2 + c v - (A_feed P_S - A_back P_T - F) = 0, K = C_q A sqrt(2/rho).
    """
    values = {"cylinder.viscous_friction": viscous, "load.gravity_cos": load}
    values |= {
        "cylinder.dead_volume_a": 2e-5,
        "cylinder.dead_volume_b": 2e-5,
    }  # stiff: the speed settles at once
    out = voltage > 0
    values["load.initial_position"] = 0.02 if out else 0.18
    signals = run(slide, values, voltage, np.linspace(0.0, 0.4, 401)).signals
    feed, back, against = (AREA_A, AREA_B, load) if out else (AREA_B, AREA_A, -load)
    k = DISCHARGE * abs(voltage) / 10 * (1.68e-6 if out else 1.63e-6) * np.sqrt(2 / DENSITY)
    a, c = (feed**3 + back**3) / k**2, -(feed * P_S - back * P_T - against)
    speed = (-viscous + np.sqrt(viscous**2 - 4 * a * c)) / (2 * a)
    # the smooth law of small drops: (dp_t/dp)^2/4 of the flow, most at the smaller of the two drops
    smaller_drop = min((feed * speed / k) ** 2, (back * speed / k) ** 2)
    tolerance = 0.25 * (0.02e6 / smaller_drop) ** 2 + 1e-4
    assert_allclose(abs(signals.velocity[-1]), speed, rtol=tolerance)
    assert np.sign(signals.velocity[-1]) == np.sign(voltage)
    assert tolerance < 2e-3
