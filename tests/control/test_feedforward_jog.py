"""The jogs with which the first large step in a direction begins: what they tell, how far they move, when they end."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.control.closed_loop import loop_on_model
from hydrolek_drake.control.conditions import span_deg
from hydrolek_drake.control.feedforward import FeedforwardLaw
from hydrolek_drake.control.feedforward_tuning import limit, tuning
from hydrolek_drake.control.rate_map import map_from_model
from hydrolek_drake.control.sdp_model import thesis_model

JOINTS = ("j1", "j2", "j3", "j4")
STEP_DEG = 30.0


def _law(joint):
    model = thesis_model(joint)
    return FeedforwardLaw(map_from_model(model), 0.05, 10.0, tuning()), model


def _with_dead_zone(model, factor):
    a = list(model.alpha)
    a[2], a[5] = a[2] * factor, a[5] * factor
    return replace(model, alpha=tuple(a))


class _Recorded:
    """A law whose states are kept."""

    def __init__(self, law):
        self.law, self.size, self.states = law, law.size, []

    def initial(self, measured_deg):
        return self.law.initial(measured_deg)

    def step(self, state, set_point_deg, measured_deg):
        found = self.law.step(state, set_point_deg, measured_deg)
        self.states.append(self.law.memory(found[0]))
        return found


def _jogged(joint, factor, sign):
    """Signals and memories, where the step itself begins, and where its jogs have been judged."""
    law, model = _law(joint)
    recorded = _Recorded(law)
    start, end = span_deg(f"right_{joint}")[:: int(sign)]
    wanted = np.full(120, end)
    signals = loop_on_model(recorded, _with_dead_zone(model, factor), wanted, 0.05, initial_deg=start)
    begun = next(k for k, memory in enumerate(recorded.states) if memory.known(sign))
    told = next(k for k, memory in enumerate(recorded.states) if memory.known(sign) and not memory.jog)
    return law, signals, recorded.states, begun, told


@pytest.mark.parametrize("sign", (-1.0, 1.0))
@pytest.mark.parametrize("factor", (1.3, 1.6))
@pytest.mark.parametrize("joint", JOINTS)
def test_jogs_tell_how_far_the_dead_zone_has_grown(joint, factor, sign):
    """Within what a way that a loaded arm may leave out stands for; the other side is taken to have grown alike."""
    unsure = (1.0 - limit("jog_less")) * limit("jog_reach")
    law, _, states, _, told = _jogged(joint, factor, sign)
    for side in (sign, -sign):
        edge = law.map.side(side).edge_V
        assert states[told].edge(side) == pytest.approx((factor - 1.0) * edge, abs=unsure * edge)


@pytest.mark.parametrize("sign", (-1.0, 1.0))
@pytest.mark.parametrize("joint", JOINTS)
def test_a_jog_of_the_joint_that_was_measured_confirms_its_map(joint, sign):
    _, _, states, _, told = _jogged(joint, 1.0, sign)
    assert states[told].edge(sign) == 0.0
    assert states[told].edge(-sign) == 0.0
    assert sum(memory.jog == 1.0 for memory in states[: told + 1]) == 1


@pytest.mark.parametrize("factor", (0.85, 1.0, 1.15, 1.3, 1.6))
@pytest.mark.parametrize("joint", JOINTS)
def test_jogs_move_the_joint_forward_by_less_than_a_tenth_of_the_step(joint, factor):
    _, signals, _, begun, _ = _jogged(joint, factor, 1.0)
    moved = signals.angle_deg[: 5 * begun] - signals.angle_deg[0]
    assert np.min(moved) == 0.0
    assert np.max(moved) < 0.1 * STEP_DEG


@pytest.mark.parametrize("joint", JOINTS)
def test_the_step_begins_as_soon_as_a_jog_is_seen(joint):
    """Two samples to just closed, two open, the dead time, and one until it is read."""
    law, signals, _, begun, _ = _jogged(joint, 1.0, 1.0)
    assert signals.time_s[5 * begun] <= (2 + limit("jog_samples") + 1) * 0.05 + law.map.dead_time_s + 1e-9


@pytest.mark.parametrize("joint", JOINTS)
def test_the_second_step_in_a_direction_begins_at_once(joint):
    law, model = _law(joint)
    recorded = _Recorded(law)
    low, high = span_deg(f"right_{joint}")
    loop_on_model(recorded, model, np.tile(np.repeat([high, low], 120), 2), 0.05, initial_deg=low)
    assert any(memory.jog for memory in recorded.states[:240])
    assert not any(memory.jog for memory in recorded.states[240:])


def test_small_steps_and_moving_set_points_are_not_jogged():
    law, model = _law("j2")
    small = 0.9 * limit("jog_from")
    for wanted in (np.full(100, small), 8.0 * 0.05 * np.arange(100)):
        recorded = _Recorded(law)
        loop_on_model(recorded, model, wanted, 0.05)
        assert not any(memory.jog for memory in recorded.states)


def test_another_set_point_ends_a_jog():
    """It begins anew from rest in the direction that is wanted then."""
    law, _ = _law("j2")
    state = law.initial(0.0)
    for _ in range(6):
        state, _, _ = law.step(state, 25.0, 0.0)
    assert law.memory(state).jog > 0.0
    state, _, _ = law.step(state, -25.0, 0.0)
    assert law.memory(state).jog == 0.0
    for _ in range(40):
        state, _, voltage = law.step(state, -25.0, 0.0)
    assert voltage < 0.0


def test_a_joint_that_never_moves_ends_in_full_voltage_so_that_the_guard_sees_it():
    """Its jogs reach further until twice the dead-zone, and no further."""
    law, _ = _law("j3")
    state, sent = law.initial(0.0), []
    for _ in range(200):
        state, _, voltage = law.step(state, 25.0, 0.0)
        sent.append(voltage)
    assert law.memory(state).known(1.0)
    assert law.memory(state).edge_up <= law.map.positive.edge_V
    assert max(sent) >= law.map.positive.voltages[-1]
    assert max(sent) <= law.limit_V
