"""A joint whose valve is closed holds, gives by its oil's compressibility, and sinks only by leakage."""

import numpy as np
from numpy.testing import assert_allclose

LEVER_AT = 25.0


def _lever_and_stroke(angle):
    included = angle + np.radians(60.0)
    length = np.sqrt(0.12**2 + 0.35**2 - 2 * 0.12 * 0.35 * np.cos(included))
    return 0.12 * 0.35 * np.sin(included) / length, length - 0.2873493667


def test_closed_valves_hold_the_joint_where_it_is(bench, run):
    outcome = run(bench, {}, 0.0, np.array([0.0, 1.0, 60.0]), longest_step=5e-4)
    assert_allclose(outcome.signals.position, np.radians(25.0), rtol=1e-12)
    assert_allclose(outcome.signals.velocity, 0.0, atol=1e-12)


def test_a_voltage_inside_the_dead_zone_moves_nothing(bench, run):
    # the spool reaches 0.03 mm of its 0.06 mm overlap
    outcome = run(bench, {}, 0.9 * np.sqrt(8000 * 0.03e-3 / 30) * 10, np.array([0.0, 5.0]))
    assert 0.02e-3 < outcome.signals.spool[-1] < 0.06e-3
    assert_allclose(outcome.signals.position, np.radians(25.0), rtol=1e-12)


def test_a_load_picked_up_presses_the_oil_by_its_compressibility_and_creeps_no_further(bench, run):
    mass, angle = 0.5, np.radians(25.0)
    values = {"effects.load.payload.mass_kg": mass, "effects.load.payload.time_s": 1.0}
    signals = run(bench, values, 0.0, np.array([0.0, 0.9, 20.0, 60.0])).signals
    lever, stroke = _lever_and_stroke(angle)
    volume_a, volume_b = 40e-6 + 800e-6 * stroke, 40e-6 + 600e-6 * (0.40 - stroke)
    oil = 1e9 * (800e-6**2 / volume_a + 600e-6**2 / volume_b) * lever**2
    # gravity and the lever change with the angle too, as part of the stiffness
    step = 1e-6
    lever_slope = (_lever_and_stroke(angle + step)[0] - _lever_and_stroke(angle - step)[0]) / (2 * step)
    gravity, payload = 265 * np.cos(angle), mass * 9.81 * np.cos(angle)
    others = -(265 + mass * 9.81) * np.sin(angle) - gravity / lever * lever_slope
    sag = signals.position[1] - signals.position[2]
    print(f"sag {sag:.3e} rad against {payload / (oil + others):.3e}")
    assert_allclose(sag, payload / (oil + others), rtol=0.01)
    assert_allclose(signals.position[3], signals.position[2], atol=1e-9)


def test_cross_port_leakage_lets_an_equal_area_cylinder_sink_at_its_closed_form_rate(bench, run):
    """With equal areas the oil that leaks across is exactly what the piston needs.

    v = -G (P_A - P_B)/A with A (P_A - P_B) lever = m g l cos q, so q' = -G m g l cos q / (A lever)^2.
    With unequal areas the rod's volume is compressed and the sinking ends; that is the next test.
    """
    conductance, area = 2e-13, 800e-6
    values = {
        "cylinder.area_b": area,
        "effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": conductance,
    }
    times = np.array([0.0, 5.0, 5.5])
    signals = run(bench, values, 0.0, times).signals
    measured = (signals.position[2] - signals.position[1]) / 0.5
    middle = 0.5 * (signals.position[2] + signals.position[1])
    lever, _ = _lever_and_stroke(middle)
    resting = 265 * np.cos(middle) + (60 + 3000 * lever**2) * measured  # dampers carry a little
    expected = -conductance * resting / (area * lever) ** 2
    print(f"sinks {measured:.4e} rad/s against {expected:.4e}")
    assert_allclose(measured, expected, rtol=1e-3)


def test_leakage_past_a_differential_piston_ends_when_the_pressures_are_equal(bench, run):
    values = {"effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": 1.5e-12}
    signals = run(bench, values, 0.0, np.array([0.0, 300.0, 320.0]), longest_step=5e-4).signals
    assert_allclose(signals.pressure_a[-1], signals.pressure_b[-1], rtol=1e-4)
    assert signals.position[1] < signals.position[0]
    assert_allclose(signals.position[2], signals.position[1], atol=1e-5)
    lever, _ = _lever_and_stroke(signals.position[-1])
    # both chambers at one pressure: only the rod's cross-section carries the load
    assert_allclose(
        (800e-6 - 600e-6) * signals.pressure_a[-1] * lever, 265 * np.cos(signals.position[-1]), rtol=1e-3
    )
