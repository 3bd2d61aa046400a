"""The numbers of joints that move together, a row for each joint, as compiled code is handed them: in few arrays.

A compiled function takes a tuple of arrays apart at every call, so that a dozen of them cost as much as the physics.
"""

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.angle import Angle
from hydrolek_drake.rollout.drive import Drive
from hydrolek_drake.rollout.rates import Slopes, State, Turned

STATE, RATES, MIDDLE, LATER, SLOPES, NEAR, DRIVE, SPOOL, VOLTS, COMMAND, PLAY, INERTIA, ROD, DRAG = (
    0, 10, 20, 30, 40, 46, 52, 57, 58, 59, 60, 61, 62, 63,
)  # fmt: skip
"""Where a joint's numbers begin in its row: `State`, its rates at the beginning of a step, the state after the first
stage and rates there, stiff slopes at the beginning, `Turned` at the last time written, `Drive`, the spool before the
step, the voltage that drives, the command, what the sensor's play reads, inertia with the others held, the rod's part
of it, and the drag that enters a step through the mass matrix."""

ROW_SIZE = 64

TORQUE, BIAS, PAYLOAD, ANGLE, SPEED = range(5)
"""Rows of what the arms' equation of motion takes and gives, a number for each joint."""

MASS, FACTOR = range(2)
"""M at the beginning of a step, and a matrix that is factored."""

OF_SUPPLY, W = State._fields.index("supply"), State._fields.index("w")
STIFF_SUPPLY, STIFF_W = Slopes._fields.index("supply"), Slopes._fields.index("w")
X = 3
"""Places of what the supply remembers and of the speed in `State` and in `Slopes`, and of the spool in `Drive`."""


def room(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Room for so many joints: rows, vectors and matrices. # (n, 64), (5, n), (2, n, n)."""
    return np.zeros((n, ROW_SIZE)), np.zeros((5, n)), np.zeros((2, n, n))


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
    rows[i, f + 9] = s.relief


@njit
def near_at(r: np.ndarray, i: int) -> Turned:
    """How far a joint had turned at the last time written."""
    f = NEAR
    return Turned(Angle(r[i, f], r[i, f + 1], r[i, f + 2]), Angle(r[i, f + 3], r[i, f + 4], r[i, f + 5]))


@njit
def slopes_at(r: np.ndarray, i: int) -> Slopes:
    """Stiff slopes at the beginning of a step."""
    f = SLOPES
    return Slopes(r[i, f], r[i, f + 1], r[i, f + 2], r[i, f + 3], r[i, f + 4], r[i, f + 5])


@njit
def drive_at(r: np.ndarray, i: int) -> Drive:
    """Ramp, coils and spool of a joint."""
    f = DRIVE
    return Drive(r[i, f], Currents(r[i, f + 1], r[i, f + 2]), r[i, f + 3], r[i, f + 4])
