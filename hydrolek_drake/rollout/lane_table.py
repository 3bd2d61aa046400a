"""The one table of numbers that the loop over lanes works in: parameter after parameter, lane beside lane."""

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.angle import AngleKept
from hydrolek_drake.rollout.drive import Drive
from hydrolek_drake.rollout.lane_view import LANES, NUMBERS
from hydrolek_drake.rollout.rates import State, Turned

_L = LANES

# Rows of the one table that the loop over the lanes works in. With several arrays the compiler would have to suppose
# that what it writes to one is what it reads from another.
# Of a state: p_a, p_b, q, w, supply, tilt, tilt_rate, lead_q, lead_w, x, xd, behind, current a, current b, play,
# relief.
STATE, NEXT = 0, 16
NEAR, NEAR_NEXT = 32, 38  # value, sine, cosine of the link's angle and of the one between the mounts
H, VOLTS, TIME, ROD = 44, 45, 46, 47
KEPT = 16  # rows of `STATE`
NUMBERS_OF_JOINT = 48
TERMS = NUMBERS_OF_JOINT + NUMBERS  # of a law, one after the other


@njit
def state_in(b: np.ndarray, first: int, lane: int) -> State:
    """The state of a machine, from row `first` on."""
    f = first * _L + lane
    return State(
        b[f],
        b[f + _L],
        b[f + 2 * _L],
        b[f + 3 * _L],
        b[f + 4 * _L],
        b[f + 5 * _L],
        b[f + 6 * _L],
        b[f + 7 * _L],
        b[f + 8 * _L],
        b[f + 15 * _L],
    )


@njit
def drive_in(b: np.ndarray, first: int, lane: int) -> Drive:
    """Ramp, coils and spool of a machine."""
    f = (first + 9) * _L + lane
    return Drive(b[f + 2 * _L], Currents(b[f + 3 * _L], b[f + 4 * _L]), b[f], b[f + _L])


@njit
def put(b: np.ndarray, first: int, lane: int, s: State, d: Drive, play: float) -> None:
    """Write a machine's state, drive, and what its sensor's play reads."""
    f = first * _L + lane
    b[f], b[f + _L], b[f + 2 * _L], b[f + 3 * _L], b[f + 4 * _L] = s.p_a, s.p_b, s.q, s.w, s.supply
    b[f + 5 * _L], b[f + 6 * _L], b[f + 7 * _L], b[f + 8 * _L] = s.tilt, s.tilt_rate, s.lead_q, s.lead_w
    b[f + 9 * _L], b[f + 10 * _L], b[f + 11 * _L] = d.x, d.xd, d.behind
    b[f + 12 * _L], b[f + 13 * _L], b[f + 14 * _L] = d.currents.a, d.currents.b, play
    b[f + 15 * _L] = s.relief


@njit
def near_in(b: np.ndarray, first: int, lane: int) -> Turned:
    """How far a machine's joint has turned."""
    f = first * _L + lane
    return Turned(
        AngleKept(b[f], b[f + _L], b[f + 2 * _L], True),
        AngleKept(b[f + 3 * _L], b[f + 4 * _L], b[f + 5 * _L], True),
    )


@njit
def put_near(b: np.ndarray, first: int, lane: int, near: Turned) -> None:
    """Write that."""
    f = first * _L + lane
    b[f], b[f + _L], b[f + 2 * _L] = near.position.value, near.position.sine, near.position.cosine
    b[f + 3 * _L], b[f + 4 * _L], b[f + 5 * _L] = (
        near.included.value,
        near.included.sine,
        near.included.cosine,
    )
