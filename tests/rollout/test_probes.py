"""Unknown inputs of the rollout: nothing changes without them, and each is what it says it is."""

import numpy as np
import pytest

from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.rollout import roll_out

TIMES = np.arange(0.0, 4.0, 0.01)
COMMAND = np.where(TIMES < 0.5, 0.0, np.where(TIMES < 2.0, 6.0, -6.0))
STEP = 5e-4


def _run(values=None, probe=None, size=0.0, command=COMMAND):
    rig = load_rig("joint_bench", {}).with_values(values or {})
    probes = None
    if probe is not None:
        rows = np.zeros((401, len(PROBES)))
        rows[:, PROBES.index(probe)] = size
        probes = (0.01, rows)
    return roll_out(rig.records(), TIMES, command, TIMES, longest_step=STEP, probes=probes).signals


@pytest.mark.parametrize("probe", PROBES)
def test_a_probe_of_zero_changes_nothing(probe: str) -> None:
    assert _run(probe=probe, size=0.0).reading.tobytes() == _run().reading.tobytes()


def test_supply_probe_is_a_higher_supply_pressure() -> None:
    probed = _run(probe="supply", size=1e6)
    assert probed.pressure_a == pytest.approx(_run({"supply.pressure": 17e6}).pressure_a, rel=1e-9)


def test_valve_probe_is_a_larger_area() -> None:
    larger = _run({"valve.max_area_a": 0.737e-6, "valve.max_area_b": 0.737e-6})
    assert _run(probe="valve", size=0.1).position == pytest.approx(larger.position, rel=1e-9)


def test_amplifier_probe_is_a_larger_current() -> None:
    larger = _run({"amplifier.max_current_a": 1.1, "amplifier.max_current_b": 1.1})
    assert _run(probe="amplifier", size=0.1).spool == pytest.approx(larger.spool, rel=1e-9)


def test_command_probe_is_a_higher_command() -> None:
    prompt = {"command.delay": 0.0}  # a delay shifts the command, not what is added to it
    always = _run(prompt, command=np.full(TIMES.size, 5.0))
    probed = _run(prompt, probe="command", size=1.0, command=np.full(TIMES.size, 4.0))
    assert probed.position == pytest.approx(always.position, rel=1e-9)


def test_sensor_probe_is_added_to_the_reading_alone() -> None:
    probed, plain = _run(probe="sensor", size=0.01), _run()
    assert probed.reading - plain.reading == pytest.approx(0.01, abs=1e-12)
    assert probed.position.tobytes() == plain.position.tobytes()


def test_load_probe_is_an_offset_force() -> None:
    rig = {"effects.load.offset_force.force_N": -40.0}
    probed, offset = _run(probe="load", size=40.0), _run(rig)
    # the rig with the offset starts in balance with it, the probed one does not: equal after the transient
    assert probed.force[-1] == pytest.approx(offset.force[-1], rel=0.02)


def test_cylinder_probe_is_the_load_probe_over_the_lever() -> None:
    force = _run(probe="cylinder", size=500.0).force - _run().force
    assert np.median(force) == pytest.approx(
        0.0, abs=60.0
    )  # the chambers give way: the rod's force balances the load
    start = _run(probe="cylinder", size=500.0).force[0] - _run().force[0]
    assert start == pytest.approx(500.0, rel=1e-9)


@pytest.mark.parametrize("side", ["a", "b"])
def test_capacity_probe_is_more_oil_in_the_chamber(side: str) -> None:
    """Oil of volume V takes V/B per pressure."""
    rig = load_rig("joint_bench", {})
    more = 2e-5
    dead = {f"cylinder.dead_volume_{s}": rig.value(f"cylinder.dead_volume_{s}") for s in "ab"}
    dead[f"cylinder.dead_volume_{side}"] += more
    larger = _run(dead)
    probed = _run(probe=f"capacity_{side}", size=more / rig.value("fluid.bulk_modulus"))
    assert probed.pressure_a == pytest.approx(larger.pressure_a, rel=1e-9)
    assert probed.position == pytest.approx(larger.position, rel=1e-9)
    assert np.abs(probed.position - _run().position).max() > 1e-4


@pytest.mark.parametrize(("probe", "volts"), [("back_a", -6.0), ("back_b", 6.0)])
def test_a_way_back_that_is_shut_holds_the_rod(probe: str, volts: float) -> None:
    """The oil in front of the piston stays there; 40 MPa, more than the areas make of the pump's, squeeze it by 4 %."""
    away = np.where(TIMES < 0.5, 0.0, volts)
    free, shut = _run(command=away), _run(probe=probe, size=-1.0, command=away)
    assert np.ptp(shut.position) < 0.1 * np.ptp(free.position)
    other = "back_b" if probe == "back_a" else "back_a"
    assert _run(probe=other, size=-1.0, command=away).position == pytest.approx(free.position, abs=1e-12)


@pytest.mark.parametrize(
    ("probe", "path", "size"),
    [
        ("ramp", "command.ramp", 0.02),
        ("coil_time", "amplifier.coil_time", 0.04),
        ("flow_force", "valve.flow_force", 0.43),
    ],
)
def test_the_probe_of_what_a_machine_has_is_the_rig_s_own_number(probe: str, path: str, size: float) -> None:
    partly_open = 0.5 * COMMAND  # a force on the spool shows nothing where the valve is wholly open
    of_the_rig = _run({path: size}, command=partly_open)
    assert _run(probe=probe, size=size, command=partly_open).position == pytest.approx(
        of_the_rig.position, abs=1e-12
    )
    assert np.abs(of_the_rig.position - _run(command=partly_open).position).max() > np.radians(0.5)


def test_a_ramp_is_the_command_ramped_by_hand() -> None:
    """Held for a millisecond each, and half of one late in the mean."""
    fine = np.arange(0.0, 4.0, 1e-3)
    ramped = np.zeros(fine.size)
    wanted = COMMAND[np.minimum((fine / 0.01 + 1e-9).astype(int), COMMAND.size - 1)]
    for n in range(1, fine.size):
        ramped[n] = np.clip(wanted[n], ramped[n - 1] - 0.05, ramped[n - 1] + 0.05)
    records = load_rig("joint_bench", {}).records()
    by_hand = roll_out(records, fine, ramped, TIMES, longest_step=STEP).signals
    by_the_card, at_once = _run({"command.ramp": 0.02}), _run()
    apart = np.abs(by_the_card.position - at_once.position).max()
    assert np.abs(by_the_card.position - by_hand.position).max() < 0.02 * apart


def test_a_rollout_goes_on_within_a_ramp_and_a_rising_current() -> None:
    rig = load_rig("joint_bench", {}).with_values({"command.ramp": 0.05, "amplifier.coil_time": 0.1})
    whole = roll_out(rig.records(), TIMES, COMMAND, TIMES, longest_step=STEP).signals
    cut = 60  # a tenth of a second after the command's jump: nothing has settled
    first = roll_out(rig.records(), TIMES, COMMAND, TIMES[: cut + 1], longest_step=STEP)
    then = roll_out(rig.records(), TIMES, COMMAND, TIMES[cut:], longest_step=STEP, state=first.state)
    assert then.signals.position == pytest.approx(whole.position[cut:], abs=1e-12)
    cold = first.state.copy()
    cold[13:] = 0.0
    other = roll_out(rig.records(), TIMES, COMMAND, TIMES[cut:], longest_step=STEP, state=cold)
    assert np.abs(other.signals.position - whole.position[cut:]).max() > np.radians(0.05)
