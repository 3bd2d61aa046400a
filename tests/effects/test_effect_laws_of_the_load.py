"""Closed forms of the effects at linkage, base, load and sensor, seen in the simulated machine."""

import numpy as np
from bench_commands import AT_REST, LOWER, UPPER, lever
from numpy.testing import assert_allclose

from hydrolek_drake.physics import hooks, sensor


def test_backlash_lets_the_link_hang_half_the_gap_below_and_no_further(drive):
    """Started centred, the load falls through half the gap and rests on the contact's spring."""
    gap = 0.012
    signals = drive({"effects.linkage.backlash.gap_rad": gap}, command=AT_REST, times=np.array([0.0, 5.0]))
    fallen = signals.position[0] - signals.position[1]
    contact = 265 * np.cos(signals.position[1]) / 2e5
    # the oil, set for this load at the start, gives nothing more once it carries it again
    assert_allclose(fallen, gap / 2 + contact, rtol=0.02)


def test_base_tilts_by_moment_over_stiffness(bench):
    from hydrolek_drake.rollout import rest_state, roll_out

    stiffness = 3e4
    values = {
        "effects.base.compliance.stiffness_Nm_per_rad": stiffness,
        "effects.base.compliance.inertia_kg_m2": 80.0,
        "base.rocking_damping_ratio": 0.5,
    }
    records = bench.with_values(values).records()
    start = rest_state(records)
    moment = 265 * np.cos(np.radians(25.0))
    assert_allclose(start[7], -moment / stiffness, rtol=1e-12)
    # the link holds its angle in space; the sensor on the base sees the tilt on top
    signals = roll_out(records, np.zeros(1), np.zeros(1), np.array([0.0, 5.0]), longest_step=5e-4).signals
    assert_allclose(signals.reading - signals.position, moment / stiffness, rtol=1e-6)
    # started level, the rocking dies out at the same tilt
    start[7] = 0.0
    late = roll_out(
        records, np.zeros(1), np.zeros(1), np.array([0.0, 20.0]), state=start, longest_step=5e-4
    ).signals
    tilt = late.position[-1] - late.reading[-1]
    assert_allclose(tilt, -265 * np.cos(late.position[-1]) / stiffness, rtol=1e-4)


def test_payload_raises_the_static_pressure_by_its_moment(drive):
    mass = 5.0
    signals = drive(
        {"effects.load.payload.mass_kg": mass, "effects.load.payload.time_s": 0.0},
        command=AT_REST,
        times=np.array([0.0, 1.0]),
    )
    plain = drive(command=AT_REST, times=np.array([0.0, 1.0]))
    angle = np.radians(25.0)
    expected = mass * 9.81 * np.cos(angle) / (800e-6 * lever(angle))
    assert_allclose(signals.pressure_a - plain.pressure_a, expected, rtol=1e-9)


def test_bow_is_largest_in_mid_travel_and_zero_at_the_ends(record):
    joint = record({"effects.sensor.nonlinearity.amplitude_rad": 0.02})
    middle = 0.5 * (LOWER + UPPER)
    assert_allclose(sensor.reading(middle, 0.0, joint) - middle, 0.02, rtol=1e-12)
    quarter = LOWER + 0.25 * (UPPER - LOWER)
    assert_allclose(sensor.reading(quarter, 0.0, joint) - quarter, 0.75 * 0.02, rtol=1e-12)
    for end in (LOWER, UPPER):
        assert_allclose(sensor.reading(end, 0.0, joint), end, atol=1e-15)


def test_reading_with_play_lags_by_half_of_it_in_both_directions(drive):
    half = 0.008
    signals = drive({"effects.sensor.hysteresis.half_width_rad": half})
    lag = signals.position - signals.reading
    fast = np.abs(signals.velocity) > 0.2
    late = fast & (np.abs(lag) > 0.999 * half)
    assert np.abs(lag).max() <= half + 1e-12
    assert late.sum() > 0.8 * fast.sum()
    assert np.all(np.sign(lag[late]) == np.sign(signals.velocity[late]))


def test_drift_has_its_slope(drive):
    times = np.linspace(0.0, 60.0, 7)
    signals = drive({"effects.sensor.drift.rate_rad_per_min": 0.03}, command=AT_REST, times=times)
    assert_allclose(signals.reading - signals.position, 0.03 * times / 60, rtol=1e-12, atol=1e-15)


def test_frictions_of_the_load_are_their_laws(record):
    joint = record(
        {
            "effects.load.coulomb_friction.force_N": 31.0,
            "effects.load.stribeck_friction.force_N": 7.0,
            "effects.load.stribeck_friction.stribeck_N": 11.0,
            "effects.load.stribeck_friction.stribeck_velocity_m_per_s": 0.1,
            "effects.load.viscous_friction.damping_N_s_per_m": 17.0,
            "effects.load.offset_force.force_N": 5.0,
            "effects.load.friction_asymmetry.coulomb_N": 3.0,
            "effects.load.friction_asymmetry.damping_N_s_per_m": 2.0,
        }
    )
    for w in (-0.3, 0.002, 0.7):
        share = np.tanh(w / np.radians(0.2))
        expected = (
            31 * share
            + (7 + 11 * np.exp(-((w / 0.1) ** 2))) * share
            + 17 * w
            + 5
            + (3 + 2 * abs(w)) * share**2
        )
        assert_allclose(hooks.load_friction(w, joint)[0], expected, rtol=1e-12)
