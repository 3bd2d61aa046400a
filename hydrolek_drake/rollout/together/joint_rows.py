"""The numbers of joints that move together, a row for each joint, as compiled code is handed them: in few arrays.

A compiled function takes a tuple of arrays apart at every call, so that a dozen of them cost as much as the physics.
"""

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.angle import AngleKept
from hydrolek_drake.rollout.drive import Drive
from hydrolek_drake.rollout.rates import Slopes, State, Turned

STATE, RATES, MIDDLE, LATER, SLOPES, NEAR, DRIVE, SPOOL, VOLTS, COMMAND, PLAY, INERTIA, ROD, DRAG = (
    0, 11, 22, 33, 44, 56, 62, 67, 68, 69, 70, 71, 72, 73,
)  # fmt: skip
"""Where a joint's numbers begin in its row: `State`, its rates at the beginning of a step, the state after the first
stage and rates there, stiff slopes at the beginning, `Turned` at the beginning, `Drive`, the spool before the
step, the voltage that drives, the command, what the sensor's play reads, inertia with the others held, the rod's part
of it, and the drag that enters a step through the mass matrix."""

MOMENT, SINE, COSINE, DRAWN, TOTAL = range(74, 79)
"""What it tells the others where its rates were taken: the moment left for motion, sine and cosine of its angle, and
the flow that it draws from the supply; and the flow that all of them draw."""

OIL, PUSH = 79, 80
"""How the oil acts on the joint within a step: `rosenbrock.through_oil`'s share, and `rosenbrock.pushed` of a stage."""

ROW_SIZE = 81

TORQUE, BIAS, PAYLOAD, SINES, COSINES, SPEEDS = range(6)
"""Rows of what the arms' equation of motion takes and gives, a number for each joint."""

MASS, LESSENED, THERE = range(3)
"""M at the beginning of a step; M with stiff friction there, and M where the first stage ended, both factored."""

OF_SUPPLY, W = State._fields.index("supply"), State._fields.index("w")
STIFF_W = Slopes._fields.index("w")
TURNED_BY, CONTACT = Slopes._fields.index("turned_by"), Slopes._fields.index("contact")
X = 3
"""Places of what the supply remembers and of the speed in `State`, of the speed and two more in `Slopes`, and of the
spool in `Drive`."""


def room(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Room for so many joints: rows, vectors and matrices. # (n, 81), (6, n), (3, n, n)."""
    return np.zeros((n, ROW_SIZE)), np.zeros((6, n)), np.zeros((3, n, n))


@njit
def state_at(rows: np.ndarray, i: int, f: int) -> State:
    """The `State` that begins at a place of a row."""
    r = rows
    return State(
        r[i, f],
        r[i, f + 1],
        r[i, f + 2],
        r[i, f + 3],
        r[i, f + 4],
        r[i, f + 5],
        r[i, f + 6],
        r[i, f + 7],
        r[i, f + 8],
        r[i, f + 9],
        r[i, f + 10],
    )


@njit
def put_state(rows: np.ndarray, i: int, f: int, s: State) -> None:
    """Write a `State`, or its rates, into a row from a place on."""
    rows[i, f], rows[i, f + 1], rows[i, f + 2], rows[i, f + 3], rows[i, f + 4] = (
        s.p_a,
        s.p_b,
        s.q,
        s.w,
        s.supply,
    )
    rows[i, f + 5], rows[i, f + 6], rows[i, f + 7], rows[i, f + 8] = s.tilt, s.tilt_rate, s.lead_q, s.lead_w
    rows[i, f + 9], rows[i, f + 10] = s.relief, s.bent


@njit
def near_at(r: np.ndarray, i: int) -> Turned:
    """How far a joint had turned at the beginning of a step."""
    f = NEAR
    return Turned(
        AngleKept(r[i, f], r[i, f + 1], r[i, f + 2], True),
        AngleKept(r[i, f + 3], r[i, f + 4], r[i, f + 5], True),
    )


@njit
def put_near(r: np.ndarray, i: int, near: Turned) -> None:
    """Write that."""
    f = NEAR
    p, m = near.position, near.included
    r[i, f], r[i, f + 1], r[i, f + 2], r[i, f + 3] = p.value, p.sine, p.cosine, m.value
    r[i, f + 4], r[i, f + 5] = m.sine, m.cosine


@njit
def slopes_at(r: np.ndarray, i: int) -> Slopes:
    """Stiff slopes at the beginning of a step."""
    f = SLOPES
    return Slopes(
        r[i, f],
        r[i, f + 1],
        r[i, f + 2],
        r[i, f + 3],
        r[i, f + 4],
        r[i, f + 5],
        r[i, f + 6],
        r[i, f + 7],
        r[i, f + 8],
        r[i, f + 9],
        r[i, f + 10],
        0.0,  # the arms' accelerations are known without it
        r[i, f + 11],
    )


@njit
def put_slopes(r: np.ndarray, i: int, slope: Slopes) -> None:
    """Write them."""
    f = SLOPES
    r[i, f], r[i, f + 1], r[i, f + 2], r[i, f + 3] = slope.p_a, slope.p_b, slope.w, slope.tilt_rate
    r[i, f + 4], r[i, f + 5], r[i, f + 6] = slope.lead_w, slope.supply, slope.falls_a
    r[i, f + 7], r[i, f + 8], r[i, f + 9] = slope.rises_b, slope.turned_by, slope.tilted_by
    r[i, f + 10], r[i, f + 11] = slope.contact, slope.lever


@njit
def drive_at(r: np.ndarray, i: int) -> Drive:
    """Ramp, coils and spool of a joint."""
    f = DRIVE
    return Drive(r[i, f], Currents(r[i, f + 1], r[i, f + 2]), r[i, f + 3], r[i, f + 4])


@njit
def put_drive(r: np.ndarray, i: int, d: Drive) -> None:
    """Write them."""
    f = DRIVE
    r[i, f], r[i, f + 1], r[i, f + 2], r[i, f + 3] = d.behind, d.currents.a, d.currents.b, d.x
    r[i, f + 4] = d.xd
