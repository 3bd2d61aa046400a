"""What each of some joints does by itself in a step of all of them: its chain, with the others held.

Rows are those of `joint_rows`, of one machine or of one lane (`lanes.numbers.LaneRows`).
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, load, sensor, supply
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.angle import AngleKept, angle_near
from hydrolek_drake.physics.probes import Probe
from hydrolek_drake.rollout.drive import Drive, driven_on
from hydrolek_drake.rollout.kernel import inertia_at
from hydrolek_drake.rollout.rates import State, Turned, carried_on, rates
from hydrolek_drake.rollout.rosenbrock import (
    changed,
    first_stage,
    implicit,
    pushed,
    second_stage,
    through_oil,
)
from hydrolek_drake.rollout.together.joint_rows import (
    COMMAND,
    COSINE,
    DRAG,
    DRAWN,
    INERTIA,
    LATER,
    MIDDLE,
    MOMENT,
    OIL,
    PLAY,
    PUSH,
    RATES,
    ROD,
    SINE,
    SPOOL,
    STATE,
    TOTAL,
    VOLTS,
    drive_at,
    near_at,
    put_drive,
    put_near,
    put_slopes,
    put_state,
    slopes_at,
    state_at,
)


@njit
def begins(
    r: np.ndarray,
    i: int,
    time: float,
    h: float,
    spool_steps: int,
    early: bool,
    outside: Probe,
    law: np.ndarray | None,
    joint: Any,
) -> None:
    """Advance ramp, coils and spool by a step, and take the rates and slopes at its beginning.

    Args:
        r: rows of the joints.
        i: which of them.
        time: since switching on [s].
        h: step [s]; in one of no length the joint stands still.
        spool_steps: steps of the spool within it.
        early: whether the joint's law acts before the spool or on it.
        outside: what the joint feels of the others' laws.
        law: of the joint, or None.
        joint: parameter record.
    """
    d, s = drive_at(r, i), state_at(r, i, STATE)
    volts = r[i, COMMAND]
    voltage = command.drive_voltage(volts, joint)
    e, drive = driven_on(
        d, s, volts, voltage, time, h, spool_steps, early, outside, outside, law, None, joint
    )
    inertia = inertia_at(time, r[i, ROD], joint)
    go = h > 0.0
    put_drive(
        r,
        i,
        Drive(
            e.behind if go else d.behind,
            Currents(e.currents.a if go else d.currents.a, e.currents.b if go else d.currents.b),
            e.x if go else d.x,
            e.xd if go else d.xd,
        ),
    )
    r[i, SPOOL], r[i, VOLTS], r[i, INERTIA] = d.x, drive, inertia
    near = near_at(r, i)
    k, slope, _, _, drawn = rates(s, d.x, drive, time, inertia, outside, law, near, h, None, None, joint)
    put_state(r, i, RATES, k)
    put_slopes(r, i, slope)
    drag, share = through_oil(slope, h, inertia, joint)
    r[i, DRAG], r[i, OIL] = drag - slope.w * inertia, share
    r[i, PUSH] = pushed(k, slope, h, joint)
    _tell(r, i, s, k.w, inertia, drawn, near, time, joint)


@njit
def _tell(
    r: np.ndarray,
    i: int,
    s: State,
    acceleration: float,
    inertia: float,
    drawn: float,
    near: Turned,
    time: float,
    joint: Any,
) -> None:
    """Write what the other joints feel of this one in a state."""
    here = angle_near(s.q, near.position)
    r[i, MOMENT] = acceleration * inertia + load.gravity_load_at(here, time, joint)
    r[i, SINE], r[i, COSINE], r[i, DRAWN] = here.sine, here.cosine, drawn


@njit
def halfway(r: np.ndarray, i: int, h: float, joint: Any) -> None:
    """The state after the first stage, once the arms' accelerations and the flow of all are known.

    Args:
        r: rows of the joints.
        i: which of them.
        h: step [s].
        joint: parameter record.
    """
    s, k = state_at(r, i, STATE), state_at(r, i, RATES)
    rate, _ = supply.rate_of_change(s.supply, s.relief, r[i, TOTAL], joint)
    slope = slopes_at(r, i)
    k = implicit(_with_supply(k, rate), slope, h, joint)
    put_state(r, i, RATES, k)
    put_state(r, i, MIDDLE, first_stage(s, k, slope, h, joint))


@njit
def _with_supply(k: State, rate: float) -> State:
    """Rates with that of what the supply remembers replaced."""
    return State(k.p_a, k.p_b, k.q, k.w, rate, k.tilt, k.tilt_rate, k.lead_q, k.lead_w, k.relief, k.bent)


@njit
def goes_on(
    r: np.ndarray, i: int, x: float, time: float, h: float, outside: Probe, law: np.ndarray | None, joint: Any
) -> None:
    """Take the rates where the first stage ended.

    Args:
        r: rows of the joints.
        i: which of them.
        x: the spool there [m].
        time: there, since switching on [s].
        h: step [s].
        outside: what the joint feels of the others' laws.
        law: of the joint, or None.
        joint: parameter record.
    """
    s, near, inertia = state_at(r, i, MIDDLE), near_at(r, i), r[i, INERTIA]
    slope, before = slopes_at(r, i), state_at(r, i, RATES)
    m, _, _, _, drawn = rates(
        s, x, r[i, VOLTS], time, inertia, outside, law, near, h, slope.contact, None, joint
    )
    put_state(r, i, LATER, m)
    r[i, PUSH] = pushed(changed(m, before), slope, h, joint)
    _tell(r, i, s, m.w, inertia, drawn, near, time, joint)


@njit
def ends(r: np.ndarray, i: int, h: float, joint: Any) -> None:
    """The state after the step, and what the sensor's play reads then; arguments as of `halfway`."""
    begun, middle = state_at(r, i, STATE), state_at(r, i, MIDDLE)
    rate, _ = supply.rate_of_change(middle.supply, middle.relief, r[i, TOTAL], joint)
    m = _with_supply(state_at(r, i, LATER), rate)
    n = second_stage(begun, state_at(r, i, RATES), m, slopes_at(r, i), h, joint)
    play, near = r[i, PLAY], near_at(r, i)
    played, after = sensor.played(play, n.q - n.tilt, joint), carried_on(near, n, joint)
    go = h > 0.0
    put_state(
        r,
        i,
        STATE,
        State(
            n.p_a if go else begun.p_a,
            n.p_b if go else begun.p_b,
            n.q if go else begun.q,
            n.w if go else begun.w,
            n.supply if go else begun.supply,
            n.tilt if go else begun.tilt,
            n.tilt_rate if go else begun.tilt_rate,
            n.lead_q if go else begun.lead_q,
            n.lead_w if go else begun.lead_w,
            n.relief if go else begun.relief,
            n.bent if go else begun.bent,
        ),
    )
    r[i, PLAY] = played if go else play
    p, q, at, m_at = after.position, near.position, after.included, near.included
    put_near(
        r,
        i,
        Turned(
            AngleKept(
                p.value if go else q.value, p.sine if go else q.sine, p.cosine if go else q.cosine, True
            ),
            AngleKept(
                at.value if go else m_at.value,
                at.sine if go else m_at.sine,
                at.cosine if go else m_at.cosine,
                True,
            ),
        ),
    )
