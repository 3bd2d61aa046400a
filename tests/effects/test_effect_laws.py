"""Closed forms of the effects from command to cylinder, seen in the simulated machine."""

import numpy as np
import pytest
from bench_commands import AT_REST, LOWER, STEP_UP, lever
from numpy.testing import assert_allclose

from hydrolek_drake.physics import amplifier, fluid, hooks, rod_friction
from hydrolek_drake.rigs import load_rig


def test_delay_shifts_the_response_by_exactly_the_delay(drive):
    delay = 0.0371  # no multiple of the step
    times = np.linspace(0.0, 1.5, 301)
    plain = drive(command=STEP_UP, times=times).position
    later = drive({"effects.command.delay.delay_s": delay}, command=STEP_UP, times=times[times < 1.4] + delay)
    assert np.ptp(plain) > 0.3
    assert_allclose(later.position, plain[times < 1.4], atol=1e-7)


def test_fade_follows_its_time_course(record):
    joint = record(
        {"effects.amplifier.gain_fade.fraction": 0.13, "effects.amplifier.gain_fade.time_constant_s": 7.0}
    )
    for time in (0.0, 3.0, 7.0, 100.0):
        expected = 0.8 * (1 - 0.13 * (1 - np.exp(-time / 7)))
        assert_allclose(amplifier.coil_currents(8.0, time, joint)[0], expected, rtol=1e-13)


def test_warm_up_thins_the_oil_on_its_time_course(record):
    joint = record({"effects.fluid.warm_up.fraction": 0.13, "effects.fluid.warm_up.time_constant_s": 7.0})
    for time in (0.0, 3.0, 7.0, 100.0):
        share = 0.13 * (1 - np.exp(-time / 7))
        assert_allclose(hooks.flow_gain(time, joint), 1 + share, rtol=1e-13)
        assert_allclose(
            rod_friction.friction_force(0.1, 0.03, 0.0, 0.0, time, joint)[0],
            3000 * (1 - share) * 0.03,
            rtol=1e-13,
        )


def test_shifted_null_takes_voltage_from_one_direction_and_gives_it_to_the_other(drive):
    """The spool that just opens: x = overlap + shift towards A, overlap - shift towards B (both at rest)."""
    shift = 1.5e-5
    for sign, overlap in ((1, 6e-5 + shift), (-1, 6e-5 - shift)):
        moves = []
        for factor in (0.97, 1.03):
            spool = overlap * factor
            current = np.sqrt(8000 * spool * (1 + 120 * spool) ** 2 / 30)
            signals = drive(
                {"effects.valve.asymmetric_overlap.shift_m": shift},
                command=((0.0,), (sign * 10 * current,)),
                times=np.array([0.0, 3.0]),
            )
            moves.append(sign * (signals.position[1] - signals.position[0]))
        assert abs(moves[0]) < 1e-12
        assert moves[1] > 1e-4


def test_spool_sticks_below_its_friction_and_lags_by_it(drive):
    """Driven slowly up and down, the spool stands friction/spring below and above its frictionless place."""
    force, volts = 0.25, 2.6
    start = np.arange(0.0, 11.0, 0.01)
    up = np.interp(start, [0, 10], [0, volts])
    down = np.interp(start, [0, 10], [5.0, volts])
    settled = [
        drive(
            {
                "effects.valve.spool_stiction.force_N": force,
                "solenoid.stiction_velocity": 1e-6,
                "solenoid.gap_constant": 1e-9,
            },
            command=(start, way),
            times=np.array([0.0, 10.1]),
            longest_step=1e-4,
        ).spool[-1]
        for way in (up, down)
    ]
    middle = 30 * (0.1 * volts) ** 2 / 8000
    assert_allclose(middle - settled[0], force / 8000, rtol=0.05)  # damping adds at this speed
    assert_allclose(settled[1] - middle, force / 8000, rtol=0.05)


def test_leaking_lands_settle_both_chambers_half_way_between_supply_and_tank(drive):
    """Q_A = Q_B = 0 needs P_A = P_B = (P_S + P_T)/2, whatever the load, which then lies on its stop."""
    signals = drive(
        {"effects.valve.null_leakage.conductance_m3_per_s_Pa": 1e-11},
        command=AT_REST,
        times=np.array([0.0, 60.0]),
    )
    assert_allclose((signals.pressure_a[-1], signals.pressure_b[-1]), 0.5 * (16e6 + 0.2e6), rtol=1e-3)
    assert signals.position[-1] < LOWER


def test_droop_lowers_the_supply_by_resistance_times_flow(drive):
    resistance = 5e10
    signals = drive(
        {"effects.supply.pressure_droop.resistance_Pa_s_per_m3": resistance},
        command=STEP_UP,
        times=np.linspace(0.0, 1.0, 1001),
    )
    moving = slice(500, 700)
    # at slow change, what is drawn is what side A takes: area times speed
    drawn = 800e-6 * lever(signals.position[moving]) * signals.velocity[moving]
    assert_allclose(16e6 - signals.supply_pressure[moving], resistance * drawn, rtol=0.02)
    assert signals.supply_pressure[moving].max() < 15e6


def test_air_softens_the_oil_at_low_pressure_only(record):
    joint = record({"effects.fluid.entrained_air.air_fraction": 0.1})
    for pressure in (0.3e6, 2e6, 15e6):
        expected = 1 / (1e-9 + 0.1 * 1e5 / pressure**2)
        assert_allclose(fluid.stiffness(1.0, pressure, joint), expected, rtol=1e-13)
    assert fluid.stiffness(1.0, 15e6, joint) > 0.9e9


@pytest.mark.parametrize("exponent", [1.0, 1.2, 1.4])
def test_air_of_a_polytropic_fluid_is_compressed_from_the_atmosphere_s_pressure(exponent):
    """A volume of oil and bubbles P V^n = const, by differences; pressures count from the atmosphere."""
    rig = load_rig("hopsan_link").with_values(
        {"fluid.air_exponent": exponent, "effects.fluid.entrained_air.air_fraction": 0.05}
    )
    joint, modulus = rig.records()[0], rig.value("fluid.bulk_modulus")
    for pressure in (0.0, 0.3e6, 2e6, 15e6):
        air = [0.05 * (1e5 / (1e5 + p)) ** (1.0 / exponent) for p in (pressure - 1.0, pressure + 1.0)]
        expected = 1.0 / (1.0 / modulus + 0.5 * (air[0] - air[1]))
        assert_allclose(fluid.stiffness(1.0, pressure, joint), expected, rtol=1e-5)


def test_leakage_past_the_piston_is_in_proportion_to_the_pressure_difference(record):
    joint = record({"effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa": 1.3e-12})
    assert hooks.cross_conductance(joint) == 1.3e-12


@pytest.mark.parametrize(("share", "holds"), [(0.9, True), (1.1, False)])
def test_coulomb_friction_balances_a_load_below_its_value(bench, share, holds):
    """A load that the pressures do not know, on a cylinder with both sides open to the tank's pressure."""
    from hydrolek_drake.rollout import rest_state, roll_out

    coulomb = 900.0
    rig = bench.with_values(
        {
            "effects.cylinder.coulomb_friction.coulomb_N": coulomb,
            "cylinder.friction_velocity": 1e-7,
            "load.gravity_cos": share * coulomb * lever(np.radians(25.0)) / np.cos(np.radians(25.0)),
            "cylinder.dead_volume_a": 1e3,  # so large that the pressures stay whatever the piston does
        }
    )
    records = rig.records()
    start = rest_state(records)
    start[2] = start[3] = 0.0
    signals = roll_out(
        records, np.zeros(1), np.zeros(1), np.array([0.0, 0.5]), state=start, longest_step=1e-4
    ).signals
    moved = signals.position[0] - signals.position[1]
    assert (moved < 1e-5) == holds
    assert moved >= 0.0


def test_coulomb_and_stribeck_friction_curves(record):
    v = np.array([-0.05, -0.003, 0.0007, 0.02])
    coulomb = record({"effects.cylinder.coulomb_friction.coulomb_N": 700.0, "cylinder.viscous_friction": 0.0})
    both = record(
        {
            "effects.cylinder.stribeck_friction.coulomb_N": 300.0,
            "effects.cylinder.stribeck_friction.stribeck_N": 400.0,
            "effects.cylinder.stribeck_friction.stribeck_velocity_m_per_s": 0.004,
            "cylinder.viscous_friction": 0.0,
        }
    )
    for speed in v:
        assert_allclose(
            rod_friction.friction_force(0.1, speed, 0.0, 0.0, 0.0, coulomb)[0],
            700 * np.tanh(speed / 0.5e-3),
            rtol=1e-13,
        )
        level = 300 + 400 * np.exp(-((speed / 0.004) ** 2))
        assert_allclose(
            rod_friction.friction_force(0.1, speed, 0.0, 0.0, 0.0, both)[0],
            level * np.tanh(speed / 0.5e-3),
            rtol=1e-13,
        )


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.0])
def test_further_friction_at_rest_fades_with_the_exponent_of_its_lubricant(record, exponent):
    stage = "effects.cylinder.stribeck_friction"
    joint = record(
        {
            f"{stage}.stribeck_N": 400.0,
            f"{stage}.stribeck_velocity_m_per_s": 0.004,
            f"{stage}.fading_exponent": exponent,
            "cylinder.viscous_friction": 0.0,
        }
    )
    for speed in (-0.05, -0.004, 0.0, 0.0007, 0.02):
        level = 400.0 * np.exp(-((abs(speed) / 0.004) ** exponent))
        assert_allclose(
            rod_friction.friction_force(0.1, speed, 0.0, 0.0, 0.0, joint)[0],
            level * np.tanh(speed / 0.5e-3),
            rtol=1e-12,
        )


def test_friction_asymmetry_is_half_the_difference_between_the_directions(record):
    joint = record(
        {
            "effects.cylinder.coulomb_friction.coulomb_N": 700.0,
            "effects.cylinder.friction_asymmetry.coulomb_N": -50.0,
            "cylinder.viscous_friction": 0.0,
        }
    )
    out, back = (rod_friction.friction_force(0.1, speed, 0.0, 0.0, 0.0, joint)[0] for speed in (0.05, -0.05))
    assert_allclose((out, back), (650.0, -750.0), rtol=1e-13)
    assert rod_friction.friction_force(0.1, 0.0, 0.0, 0.0, 0.0, joint)[0] == 0.0


@pytest.mark.parametrize(
    ("stroke", "velocity", "expected"),
    [(0.012, -0.03, -1e5 * 0.03 * 0.6), (0.012, 0.03, 0.0), (0.031, -0.03, 0.0), (0.0, -0.03, -1e5 * 0.03)],
)
def test_cushion_brakes_only_the_last_part_of_retraction(record, stroke, velocity, expected):
    joint = record(
        {
            "effects.cylinder.end_cushion.damping_N_s_per_m": 1e5,
            "effects.cylinder.end_cushion.length_m": 0.03,
            "cylinder.viscous_friction": 0.0,
        }
    )
    assert_allclose(
        rod_friction.friction_force(stroke, velocity, 0.0, 0.0, 0.0, joint)[0], expected, rtol=1e-12, atol=0
    )
