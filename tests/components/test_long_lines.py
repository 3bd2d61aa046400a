"""A long line's chain of segments beside waves in a tube: quarter wave, water hammer, losses; Diagram and rollout."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.optimize import brentq

from hydrolek_drake.compiling import njit
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import cylinder, linkage
from hydrolek_drake.physics.lines.long_line import Line, Source, line_rates, pipes, resistance
from hydrolek_drake.physics.lines.long_line import Lines as BothLines
from hydrolek_drake.physics.probes import no_probe
from hydrolek_drake.replay.by_diagram import moved_by_diagram
from hydrolek_drake.replay.driving import Driven
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.lines import lines_advanced
from hydrolek_drake.rollout.rates import State
from hydrolek_drake.rollout.together.together import JointsTogether

SPEED, DENSITY = 1200.0, 870.0
LENGTH, BORE = 6.0, 8e-3
AREA = 0.25 * math.pi * BORE**2


def _lossless(with_component, **values):
    return with_component("long_line").with_values(
        {"hose.viscosity": 0.0, "hose.loss_a": 0.0, "fluid.density": DENSITY}
        | {f"hose.{name}": value for name, value in values.items()}
    )


def _matrix(rig, source):
    """Of the equations of a line, pressures and flows from the valve on, whose chamber has no oil of its own."""
    of, _ = pipes(rig.records()[0])

    def rates(y):
        return [*line_rates(Line(*y[:8]), source, y[8], of), y[7] / (0.5 * of.capacity)]

    scale = np.array([1e5, 1e-5] * 4 + [1e5])
    scaled = np.array([np.array(rates(scale * unit)) / scale for unit in np.eye(9)]).T
    return scale[:, None] * scaled / scale


def _frequencies(rig, source):
    """All its oscillations [Hz]."""
    waves = np.abs(np.linalg.eigvals(_matrix(rig, source)).imag) / (2.0 * math.pi)
    return np.unique(waves[waves > 1e-3].round(6))


def test_a_line_that_is_closed_at_its_end_and_open_at_the_valve_rings_with_a_quarter_wave(with_component):
    found = _frequencies(_lossless(with_component), Source(0.0, 1.0))  # all of the flow at no pressure
    odd = np.array([1, 3, 5, 7])
    chain = SPEED / (LENGTH / 4) * np.sin(odd * math.pi / 16) / math.pi  # of four pi-segments, exactly
    assert_allclose(found, chain, rtol=1e-5)
    assert found[0] == pytest.approx(SPEED / (4 * LENGTH), rel=7e-3)
    assert found[1] == pytest.approx(3 * SPEED / (4 * LENGTH), rel=6e-2)


def test_a_line_that_is_closed_at_both_ends_rings_with_a_half_wave(with_component):
    found = _frequencies(_lossless(with_component), Source(0.0, 0.0))
    assert found[0] == pytest.approx(SPEED / (2 * LENGTH), rel=3e-2)


@njit
def _ringing(lines, s, steps, h, joint, out):
    """Pressures of chamber A and of its valve's port [Pa], step by step, with the piston held and the valve shut."""
    stroke, _ = linkage.stroke_and_lever(s.q, joint)
    for i in range(steps):
        lines, fed = lines_advanced(lines, s, 0.0, 0.0, h, no_probe(), no_probe(), joint)
        rate_a, rate_b, _, _ = cylinder.pressure_rates(s.p_a, s.p_b, fed.a, fed.b, stroke, 0.0, joint)
        s = State(
            s.p_a + h * rate_a, s.p_b + h * rate_b, s.q, 0.0, s.supply, 0.0, 0.0, s.q, 0.0, s.relief, 0.0
        )
        out[i, 0], out[i, 1] = s.p_a, lines.a.p_0
    return lines


def _retracted(joint, p):
    """At rest without any stroke, where chamber A is its dead volume."""
    q = brentq(lambda angle: linkage.stroke_and_lever(angle, joint)[0], -0.6, 0.6)
    return State(p, p, q, 0.0, 0.0, 0.0, 0.0, q, 0.0, 0.0, 0.0)


def test_a_flow_that_is_stopped_gives_the_water_hammer_of_joukowsky(with_component):
    """rho c dv at the shut end until the wave of the other end arrives after L/c; less by as much at that end.

    A chain of lumps ripples about it, and its front is no step, so that what is told is the pressure's impulse.
    """
    rig = _lossless(with_component).with_values({"cylinder.dead_volume_a": 1e-9})
    joint = rig.records()[0]
    flow, p, h = 0.5 * AREA, 8e6, 2e-5
    at = Line(p, flow, p, flow, p, flow, p, flow)
    out = np.empty((round(2 * LENGTH / SPEED / h), 2))
    _ringing(BothLines(at, at), _retracted(joint, p), len(out), h, joint, out)
    hammer, way = DENSITY * SPEED * 0.5, LENGTH / SPEED
    of, _ = pipes(joint)
    assert_allclose(math.sqrt(of.inertance / of.capacity) * flow, hammer, rtol=1e-9)
    matrix = _matrix(rig, Source(0.0, 0.0))
    moved = [
        expm(matrix * h * (i + 1)) @ [0.0, flow, 0.0, flow, 0.0, flow, 0.0, flow, 0.0]
        for i in range(len(out))
    ]
    for more, exact in ((out[:, 0] - p, np.array(moved)[:, 8]), (p - out[:, 1], -np.array(moved)[:, 0])):
        assert_allclose(more, exact, atol=5e-3 * hammer)
        lasts = int(np.argmax(more < 0.0))
        assert more[:lasts].sum() * h == pytest.approx(hammer * way, rel=0.1)
        assert way < lasts * h < 1.3 * way


def test_steps_that_do_not_see_the_waves_stay_stable(with_component):
    rig = _lossless(with_component, length_a=0.05, length_b=0.05).with_values(
        {"cylinder.dead_volume_a": 1e-9}
    )
    joint = rig.records()[0]
    at = Line(*[8e6, 1e-4] * 4)
    out = np.empty((200, 2))
    _ringing(BothLines(at, at), _retracted(joint, 8e6), 200, 1e-3, joint, out)
    assert np.isfinite(out).all()
    assert np.abs(out[-1] - 8e6).max() < 1e5  # what no step can see dies out


@pytest.mark.parametrize(("reynolds", "factor"), [(200.0, 64 / 200.0), (2e4, 0.3164 / 2e4**0.25)])
def test_steady_flow_loses_what_darcy_says(with_component, reynolds, factor):
    rig = with_component("long_line").with_values({"hose.loss_a": 0.0, "fluid.density": DENSITY})
    speed = reynolds * 46e-6 / BORE
    of, _ = pipes(rig.records()[0])
    flow = speed * AREA
    lost = 4 * resistance(-flow, of) * flow
    assert_allclose(lost, factor * LENGTH / BORE * 0.5 * DENSITY * speed**2, rtol=1e-9)


@pytest.mark.thorough
def test_a_short_wide_line_is_no_line_but_its_oil(with_component):
    rig = _lossless(with_component, length_a=0.1, length_b=0.1, bore_a=12e-3, bore_b=12e-3, wave_speed=1000.0)
    bench = load_rig("joint_bench")
    oil = 0.1 * 0.25 * math.pi * 12e-3**2 / (DENSITY * 1000.0**2) * bench.value("fluid.bulk_modulus")
    plain = bench.with_values(
        {f"cylinder.dead_volume_{side}": bench.value(f"cylinder.dead_volume_{side}") + oil for side in "ab"}
    ).with_values({"fluid.density": DENSITY})
    times = np.arange(0.0, 3.0, 0.01)
    volts = np.repeat(np.random.default_rng(7).uniform(-6.0, 6.0, 10), 30)
    lined, alone = (
        roll_out(each.records(), times, volts, times, longest_step=2e-4).signals for each in (rig, plain)
    )
    assert np.degrees(np.abs(lined.position - alone.position).max()) < 0.03
    assert np.degrees(np.ptp(alone.position)) > 5.0


def test_steps_of_the_rig_follow_what_finer_ones_do(with_component):
    rig = with_component("long_line")
    times = np.arange(0.0, 3.0, 0.01)
    volts = np.repeat(np.random.default_rng(3).uniform(-6.0, 6.0, 10), 30)
    errors = []
    exact = roll_out(rig.records(), times, volts, times, longest_step=2e-5).signals
    for step in (8e-4, 4e-4):
        coarse = roll_out(rig.records(), times, volts, times, longest_step=step).signals
        errors.append(float(np.degrees(np.abs(coarse.position - exact.position).max())))
    assert errors[0] < 0.03
    assert errors[1] < 0.5 * errors[0]  # second order: a quarter


def test_the_diagram_has_the_same_waves(with_component):
    rig = with_component("long_line")
    times = np.arange(0.0, 1.5, 0.005)
    volts = np.where(times < 0.5, 5.0, np.where(times < 1.0, 0.0, -5.0))
    (moved,) = moved_by_diagram(rig, [Driven("joint", times, volts, None)], times, {}).values()
    alone = roll_out(rig.records(), times, volts, times, longest_step=1e-4).signals
    without = roll_out(load_rig("joint_bench").records(), times, volts, times, longest_step=1e-4).signals
    for name in ("pressure_a", "pressure_b"):
        own, other = getattr(alone, name), getattr(moved.signals, name)
        waves = np.sqrt(np.mean((own - getattr(without, name)) ** 2))
        assert np.sqrt(np.mean((own - other) ** 2)) < 0.1 * waves
    assert_allclose(moved.signals.position, alone.position, atol=2e-4)


@pytest.mark.thorough
def test_a_rollout_goes_on_with_its_waves_where_it_ended(with_component):
    record = with_component("long_line").records()
    times = np.arange(0.0, 0.6, 0.01)
    volts = np.where(times < 0.2, 6.0, 0.0)
    whole = roll_out(record, times, volts, times, longest_step=5e-4)
    first = roll_out(record, times, volts, times[:31], longest_step=5e-4)
    second = roll_out(record, times, volts, times[30:], state=first.state, longest_step=5e-4)
    assert_allclose(second.signals.pressure_a, whole.signals.pressure_a[30:], rtol=1e-9)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("long_line_of_a_pump", "lead from a valve's edges"),
        ("held_long_line", "behind a long line is not modelled"),
    ],
)
def test_what_a_long_line_cannot_lead_from_or_to_is_refused(with_component, name, says):
    with pytest.raises(InputError, match=says):
        with_component(name)


def test_joints_that_move_together_refuse_long_lines_in_one_line(with_component):
    with pytest.raises(InputError, match="of joints that move alone") as caught:
        JointsTogether(with_component("long_line"), ["joint"])
    assert "\n" not in str(caught.value)
