"""One joint's chain of stages, integrated in one compiled loop.

The rates of its state come from `rates`, the equations of its stages from `physics`, a step from `rosenbrock`. Steps
end exactly where the delayed command changes, so that a fit sees the transport delay as a smooth parameter.
"""

import math
from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import cavity, command, cylinder, hooks, linkage, load, sensor
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.driven import is_followed, pressure_told
from hydrolek_drake.physics.lines.long_line import Lines, lines_in, put_lines
from hydrolek_drake.physics.probes import Probe, probe_at
from hydrolek_drake.physics.solenoid import steps_needed
from hydrolek_drake.physics.supply import supply_pressure
from hydrolek_drake.physics.usual import rare
from hydrolek_drake.rollout.drive import Drive, acts_early, driven_on
from hydrolek_drake.rollout.lines import fed_now, lines_advanced
from hydrolek_drake.rollout.rates import (
    State,
    Turned,
    as_recorded,
    carried_on,
    felt_at,
    kept,
    rates,
    rod_side,
    turned,
)
from hydrolek_drake.rollout.rosenbrock import one_step
from hydrolek_drake.rollout.stretches import arrived, next_stretch

SIGNALS = (
    "reading",
    "position",
    "velocity",
    "pressure_a",
    "pressure_b",
    "spool",
    "supply_pressure",
    "force",
    "current",
)

PULLED = ("reading", "pressure_a", "pressure_b")
NOT_PULLED = np.zeros((0, len(PULLED)))


@njit
def inertia_at(time: float, rod: float, joint: Any) -> float:
    """Inertia of the load with its payload and of the rod at the joint [kg m^2 or kg]."""
    return load.moving_inertia(time, joint) + rod


@njit
def out_of_bounds(x: float, s: State) -> bool:
    """Whether anything is NaN or far beyond what a machine can do."""
    return not (
        abs(s.q) < 1e3
        and abs(s.w) < 1e6
        and s.p_a < 1e12
        and s.p_b < 1e12
        and abs(x) < 1e3
        and abs(s.supply) < 1e12
        and abs(s.tilt) < 1e3
        and abs(s.lead_q) < 1e3
    )


@njit
def current_read(s: State, voltage: float, joint: Any) -> float:
    """What the sensor of an electric motor's current says in a state [A], at a voltage of its drive [V]; else 0."""
    if not cylinder.is_electric(joint):
        return 0.0
    q, w = rod_side(s, joint)
    place, lever = linkage.stroke_and_lever(q, joint)
    current = cylinder.motor_current(voltage, place, lever * w, s.supply, s.relief, joint)
    return sensor.current_reading(current, joint)


@njit
def written(
    d: Drive,
    s: State,
    play: float,
    volts: float,
    time: float,
    inertia: float,
    probe: Probe,
    law: np.ndarray | None,
    near: Turned,
    lines: Lines | None,
    joint: Any,
    out: np.ndarray,
) -> float:
    """Write a joint's `SIGNALS` at one moment, see `integrate`; the flow that it draws then [m^3/s].

    Args:
        d: ramp, coils and spool.
        s: the rest of the state.
        play: what the sensor's play reads.
        volts: of the command that acts.
        time: since switching on [s].
        inertia: of what moves.
        probe: inputs from outside.
        law: how such inputs follow from the state, or None.
        near: a place that the joint is near to or at.
        lines: between valve and chambers where these are long, or None.
        joint: parameter record.
        out: receives the signals. # (9,)
    """
    x = d.x
    if rare(joint):
        s, x = as_recorded(s, x, probe, joint)
    now = felt_at(probe, law, time, s, x, joint)
    voltage = command.drive_voltage(volts + now.command, joint)
    drive = d.behind if joint.command.ramp + now.ramp > 0.0 else voltage
    if lines is None:
        fed = None
    else:
        fed = fed_now(lines, s, x, time, probe, now, joint)
    _, _, p_supply, force, drawn = rates(s, x, drive, time, inertia, probe, law, near, 0.0, None, fed, joint)
    out[0] = sensor.reading(play, time, joint) + now.sensor
    out[1], out[2], out[5] = s.q, s.w, x
    out[3], out[4] = cavity.pressures(s.p_a, s.p_b, joint)
    out[6] = pressure_told(s.supply, p_supply, probe, now, joint)
    out[7], out[8] = force, current_read(s, drive, joint)
    return drawn


@njit
def pulled(s: State, share: float, reading: float, measured: np.ndarray, joint: Any) -> tuple[State, float]:
    """The state with a share of what was measured beyond it, and by how much its position was moved."""
    by = share * (measured[0] - reading) if math.isfinite(measured[0]) else 0.0
    moved = State(
        cavity.pulled(s.p_a, share, measured[1]),
        cavity.pulled(s.p_b, share, measured[2]),
        s.q + by,
        s.w,
        s.supply,
        s.tilt,
        s.tilt_rate,
        s.lead_q + by,
        s.lead_w,
        s.relief,
        s.bent,
    )
    return moved, by


@njit
def supply_pulled(s: State, share: float, outside: Probe, joint: Any) -> State:
    """The state with a share of what the recorded supply pressure is beyond that of a supply that is followed."""
    if not is_followed(joint):
        return s
    supply = s.supply + share * (outside.supply - supply_pressure(s.supply, joint))
    return State(s.p_a, s.p_b, s.q, s.w, supply, s.tilt, s.tilt_rate, s.lead_q, s.lead_w, s.relief, s.bent)


@njit(cache=True, nogil=True)
def integrate(
    joints: np.ndarray,
    state: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    longest_step: float,
    spool_steps: int,
    probe_spacing: float,
    probe_values: np.ndarray,
    pull_time: float,
    measured: np.ndarray,
    law: np.ndarray | None,
    lines: np.ndarray | None,
    out: np.ndarray,
) -> int:
    """Integrate one joint through a command and write its signals at `times`.

    Args:
        joints: parameter record, shape (1,).
        state: x, spool velocity, then `State` but its last two, what the sensor's play reads, the time since
            switching on [s] at the first of `times`, the voltage behind the ramp [V], the coils' `Currents`, and these
            two; shape (18,); holds the final state afterwards.
        command_times: when the command changes [s], shape (m,).
        command_values: held from then on [V], shape (m,); neutral before the first one has arrived.
        times: when to write [s], shape (n,); the integration starts at the first.
        longest_step: [s].
        spool_steps: spool steps within one step.
        probe_spacing: of the samples of the probes, which begin at the first of `times` [s].
        probe_values: `PROBES` over time, shape (k, 15); no rows for none.
        pull_time: with this time constant reading and pressures are pulled to what was measured, as in an
            observer [s]; zero or less for a free rollout.
        measured: `PULLED` at `times`, NaN where there is no value, shape (n, 3); no rows for a free rollout.
        law: how inputs from outside follow from the state, rows of `law.LAW`, or None.
        lines: between valve and chambers where these are long, as of `lines.lines_in`, shape (16,), or None; holds
            their final state afterwards.
        out: `SIGNALS`, before the pull, shape (n, 9).

    Returns:
        Number of rows written; less than n if the simulation diverged at that row.
    """
    joint = joints[0]
    d = Drive(state[13], Currents(state[14], state[15]), state[0], state[1])
    s = State(
        state[2], state[3], state[4], state[5], state[6], state[7], state[8], state[9], state[10],
        state[16], state[17],
    )  # fmt: skip
    line: Any
    if lines is None:
        line = None
    else:
        line = lines_in(lines)
    playing = hooks.linkage_gap(joint) > 0.0
    rocking = hooks.base_stiffness(joint) > 0.0
    early = acts_early(law, joint)
    spool_steps = steps_needed(spool_steps, joint)
    delay = command.transport_delay(joint)
    rod = load.reflected_rod_inertia(joint)
    begin = times[0]
    held = -1  # nothing has arrived yet
    play = state[11]
    on = begin - state[12]
    t = begin
    for row in range(len(times)):
        target = times[row]
        near = kept(turned(s, joint))
        while t < target:
            until, held, volts, steps, h = next_stretch(
                t, target, held, delay, command_times, command_values, longest_step, joint
            )
            probe = probe_at(t, begin, probe_spacing, probe_values)
            voltage = command.drive_voltage(volts + probe.command, joint)
            if h > 0.0:
                for i in range(steps):
                    time = t + i * h - on
                    probe_next = probe_at(t + (i + 1) * h, begin, probe_spacing, probe_values)
                    x = d.x
                    if lines is None:
                        ports, fed = None, None
                    else:
                        ports = line.a.p_0, line.b.p_0
                    d, drive = driven_on(
                        d,
                        s,
                        volts,
                        voltage,
                        time,
                        h,
                        spool_steps,
                        early,
                        probe,
                        probe_next,
                        law,
                        ports,
                        joint,
                    )
                    if lines is not None:
                        middle = 0.5 * (x + d.x)
                        acting = felt_at(probe, law, time, s, middle, joint)
                        line, fed = lines_advanced(line, s, middle, time, h, probe, acting, joint)
                    inertia = inertia_at(time, rod, joint)
                    s = one_step(s, x, d.x, drive, time, h, inertia, probe, probe_next, law, near, fed, joint)
                    near = carried_on(near, s, joint)
                    probe = probe_next
                    play = sensor.played(play, s.q - s.tilt, joint)
            t = until
        if out_of_bounds(d.x, s):
            return row
        probe = probe_at(t, begin, probe_spacing, probe_values)
        inertia = inertia_at(t - on, rod, joint)
        volts = arrived(command_values, held, joint)
        written(d, s, play, volts, t - on, inertia, probe, law, near, line, joint, out[row])
        if pull_time > 0.0 and row + 1 < len(times):
            share = 1.0 - math.exp((t - times[row + 1]) / pull_time)
            s, by = pulled(s, share, out[row, 0], measured[row], joint)
            s = supply_pulled(s, share, probe, joint)
            play += by
    if not playing:
        s = State(s.p_a, s.p_b, s.q, s.w, s.supply, s.tilt, s.tilt_rate, s.q, s.w, s.relief, s.bent)
    if not rocking:
        s = State(s.p_a, s.p_b, s.q, s.w, s.supply, 0.0, 0.0, s.lead_q, s.lead_w, s.relief, s.bent)
    state[0], state[1] = d.x, d.xd
    state[2], state[3], state[4], state[5], state[6] = s.p_a, s.p_b, s.q, s.w, s.supply
    state[7], state[8], state[9], state[10] = s.tilt, s.tilt_rate, s.lead_q, s.lead_w
    state[11], state[12] = play, times[-1] - on
    state[13], state[14], state[15] = d.behind, d.currents.a, d.currents.b
    state[16], state[17] = s.relief, s.bent
    if lines is not None:
        put_lines(lines, line)
    return len(times)
