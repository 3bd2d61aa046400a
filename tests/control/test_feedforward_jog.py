"""The jogs with which the first large step in a direction begins: what they tell, how far they move, when they end."""

import numpy as np
import pytest

from hydrolek_drake.control.closed_loop import loop_on_model
from hydrolek_drake.control.comparison.conditions import span_deg
from hydrolek_drake.control.laws.feedforward_tuning import limit

JOINTS = ("j1", "j2", "j3", "j4")
STEP_DEG = 30.0


@pytest.fixture(scope="module")
def jogged(modelled, changed, recorded):
    """(joint, factor, sign) -> law, signals, memories, where the step begins, where its jogs have been judged."""

    def made(joint, factor, sign):
        law, model = modelled(joint)
        kept = recorded(law)
        start, end = span_deg(f"right_{joint}")[:: int(sign)]
        signals = loop_on_model(
            kept, changed(model, wider=factor), np.full(120, end), 0.05, initial_deg=start
        )
        begun = next(k for k, memory in enumerate(kept.states) if memory.known(sign))
        told = next(k for k, memory in enumerate(kept.states) if memory.known(sign) and not memory.jog)
        return law, signals, kept.states, begun, told

    return made


@pytest.mark.parametrize("sign", (-1.0, 1.0))
@pytest.mark.parametrize("factor", (1.3, 1.6))
@pytest.mark.parametrize("joint", JOINTS)
def test_jogs_tell_how_far_the_dead_zone_has_grown(jogged, joint, factor, sign):
    """Within what a way that a loaded arm may leave out stands for; the other side is taken to have grown alike."""
    unsure = (1.0 - limit("jog_less")) * limit("jog_reach")
    law, _, states, _, told = jogged(joint, factor, sign)
    for side in (sign, -sign):
        edge = law.map.side(side).edge_V
        assert states[told].edge(side) == pytest.approx((factor - 1.0) * edge, abs=unsure * edge)


@pytest.mark.parametrize("sign", (-1.0, 1.0))
@pytest.mark.parametrize("joint", JOINTS)
def test_a_jog_of_the_joint_that_was_measured_confirms_its_map(jogged, joint, sign):
    _, _, states, _, told = jogged(joint, 1.0, sign)
    assert states[told].edge(sign) == 0.0
    assert states[told].edge(-sign) == 0.0
    assert sum(memory.jog == 1.0 for memory in states[: told + 1]) == 1


@pytest.mark.parametrize("factor", (0.85, 1.0, 1.15, 1.3, 1.6))
@pytest.mark.parametrize("joint", JOINTS)
def test_jogs_move_the_joint_forward_by_less_than_a_tenth_of_the_step(jogged, joint, factor):
    _, signals, _, begun, _ = jogged(joint, factor, 1.0)
    moved = signals.angle_deg[: 5 * begun] - signals.angle_deg[0]
    assert np.min(moved) == 0.0
    assert np.max(moved) < 0.1 * STEP_DEG


@pytest.mark.parametrize("joint", JOINTS)
def test_the_step_begins_as_soon_as_a_jog_is_seen(jogged, joint):
    """Two samples to just closed, two open, the dead time, and one until it is read."""
    law, signals, _, begun, _ = jogged(joint, 1.0, 1.0)
    assert signals.time_s[5 * begun] <= (2 + limit("jog_samples") + 1) * 0.05 + law.map.dead_time_s + 1e-9


@pytest.mark.parametrize("joint", JOINTS)
def test_the_second_step_in_a_direction_begins_at_once(modelled, recorded, joint):
    law, model = modelled(joint)
    kept = recorded(law)
    low, high = span_deg(f"right_{joint}")
    loop_on_model(kept, model, np.tile(np.repeat([high, low], 120), 2), 0.05, initial_deg=low)
    assert any(memory.jog for memory in kept.states[:240])
    assert not any(memory.jog for memory in kept.states[240:])


def test_small_steps_and_moving_set_points_are_not_jogged(modelled, recorded):
    law, model = modelled("j2")
    small = 0.9 * limit("jog_from")
    for wanted in (np.full(100, small), 8.0 * 0.05 * np.arange(100)):
        kept = recorded(law)
        loop_on_model(kept, model, wanted, 0.05)
        assert not any(memory.jog for memory in kept.states)


def test_another_set_point_ends_a_jog(modelled):
    """It begins anew from rest in the direction that is wanted then."""
    law, _ = modelled("j2")
    state = law.initial(0.0)
    for _ in range(6):
        state, _, _ = law.step(state, 25.0, 0.0)
    assert law.memory(state).jog > 0.0
    state, _, _ = law.step(state, -25.0, 0.0)
    assert law.memory(state).jog == 0.0
    for _ in range(40):
        state, _, voltage = law.step(state, -25.0, 0.0)
    assert voltage < 0.0


def test_a_joint_that_never_moves_ends_in_full_voltage_so_that_the_guard_sees_it(modelled):
    """Its jogs reach further until twice the dead-zone, and no further."""
    law, _ = modelled("j3")
    state, sent = law.initial(0.0), []
    for _ in range(200):
        state, _, voltage = law.step(state, 25.0, 0.0)
        sent.append(voltage)
    assert law.memory(state).known(1.0)
    assert law.memory(state).edge_up <= law.map.positive.edge_V
    assert max(sent) >= law.map.positive.voltages[-1]
    assert max(sent) <= law.limit_V
