"""What moves between a joint's command and its ports: ramp, coils and spool, ahead of the rest of a step."""

from typing import Any, NamedTuple

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import amplifier, cavity, command, solenoid, valve
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.driven import chamber_pressures, pressure_at_valves
from hydrolek_drake.physics.law import up_to_the_spool
from hydrolek_drake.physics.probes import Probe
from hydrolek_drake.rollout.rates import State, felt_at


class Drive(NamedTuple):
    """What moves between a joint's command and its ports."""

    behind: float  # voltage behind the ramp [V]
    currents: Currents  # of the coils
    x: float  # spool position [m]
    xd: float  # its velocity


@njit
def driven_on(
    d: Drive,
    s: State,
    volts: float,
    voltage: float,
    time: float,
    h: float,
    spool_steps: int,
    early: bool,
    probe: Probe,
    probe_next: Probe,
    law: np.ndarray | None,
    ports: tuple[float, float] | None,
    joint: Any,
) -> tuple[Drive, float]:
    """Advance ramp, coils and spool by `h` seconds; also the voltage that drives meanwhile.

    Args:
        d: where they are.
        s: the rest of the state.
        volts: of the command that acts.
        voltage: of the drive, without what a law adds to the command.
        time: since switching on [s].
        h: [s].
        spool_steps: steps of the spool within `h`, see `solenoid.steps_needed`.
        early: whether a law acts before the spool or on it.
        probe: inputs from outside now.
        probe_next: after the step.
        law: how inputs from outside follow from the state, or None.
        ports: pressures at the valve's ports A and B where long lines lead on from them [Pa], or None.
        joint: parameter record.
    """
    gain = 0.0
    now = probe
    if early:
        now = felt_at(probe, law, time, s, d.x, joint)
        gain = now.amplifier - probe.amplifier
        voltage = command.drive_voltage(volts + now.command, joint)
    behind, drive = command.ramped(d.behind, voltage, h, now.ramp, joint)
    currents, driving = amplifier.following(d.currents, drive, time + 0.5 * h, h, now.coil_time, joint)
    gain += 1.0 + 0.5 * (probe.amplifier + probe_next.amplifier)
    p_a, p_b = _beside_the_spool(s, probe, ports, joint)
    closing_a, closing_b = valve.flow_forces(
        pressure_at_valves(s.supply, probe, now, joint), p_a, p_b, now.flow_force, joint
    )
    x, xd = solenoid.advanced(
        d.x, d.xd, gain * driving.a, gain * driving.b, h, spool_steps, joint, closing_a, closing_b
    )
    return Drive(behind, currents, x, xd), drive


@njit
def _beside_the_spool(
    s: State, probe: Probe, ports: tuple[float, float] | None, joint: Any
) -> tuple[float, float]:
    """Pressures at the valve's ports A and B [Pa]: of the chambers, unless long lines lead on to these."""
    if ports is None:
        p_a, p_b = cavity.pressures(s.p_a, s.p_b, joint)
        return chamber_pressures(p_a, p_b, probe, joint)
    return ports


@njit
def acts_early(law: np.ndarray | None, joint: Any) -> bool:
    """Whether a law acts before the spool or on it."""
    return up_to_the_spool(law) or (law is not None and joint.valve.flow_force > 0.0)
