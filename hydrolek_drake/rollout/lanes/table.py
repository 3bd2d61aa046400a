"""The one table of numbers that the loop over lanes works in: parameter after parameter, lane beside lane."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.angle import AngleKept
from hydrolek_drake.physics.law import LAW
from hydrolek_drake.physics.probes import Probe
from hydrolek_drake.rollout.drive import Drive
from hydrolek_drake.rollout.lanes.view import LANES, NUMBERS
from hydrolek_drake.rollout.rates import State, Turned

_L = LANES

# Rows of the one table that the loop over the lanes works in. With several arrays the compiler would have to suppose
# that what it writes to one is what it reads from another.
# Of a state: p_a, p_b, q, w, supply, tilt, tilt_rate, lead_q, lead_w, x, xd, behind, current a, current b, play,
# relief, bent.
STATE, NEXT = 0, 17
NEAR, NEAR_NEXT = 34, 40  # value, sine, cosine of the link's angle and of the one between the mounts
# Step [s], command that acts [V], time since switching on [s]; with inputs from outside also the command with what they
# add to it where it begins to act, and the shares of the way between samples before and after the step.
H, VOLTS, TIME, COMMANDED, SHARE, SHARE_NEXT = 46, 47, 48, 49, 50, 51
PLANNED = 6  # these rows
ROD = 52
# Samples of the inputs from outside, and by how much they rise to the next ones, before and after the step.
SAMPLE, RISE, SAMPLE_NEXT, RISE_NEXT = 53, 68, 83, 98
KEPT = 17  # rows of `STATE`
NUMBERS_OF_JOINT = 113
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
        b[f + 16 * _L],
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
    b[f + 15 * _L], b[f + 16 * _L] = s.relief, s.bent


@njit
def probe_in(b: np.ndarray, sample: int, share: int, lane: int) -> Probe:
    """Inputs from outside to a machine, from its rows of samples and their rises, and of the share."""
    s, r, f = sample * _L + lane, (sample + RISE - SAMPLE) * _L + lane, b[share * _L + lane]
    return Probe(
        b[s] + f * b[r],
        b[s + _L] + f * b[r + _L],
        b[s + 2 * _L] + f * b[r + 2 * _L],
        b[s + 3 * _L] + f * b[r + 3 * _L],
        b[s + 4 * _L] + f * b[r + 4 * _L],
        b[s + 5 * _L] + f * b[r + 5 * _L],
        b[s + 6 * _L] + f * b[r + 6 * _L],
        b[s + 7 * _L] + f * b[r + 7 * _L],
        b[s + 8 * _L] + f * b[r + 8 * _L],
        b[s + 9 * _L] + f * b[r + 9 * _L],
        b[s + 10 * _L] + f * b[r + 10 * _L],
        b[s + 11 * _L] + f * b[r + 11 * _L],
        b[s + 12 * _L] + f * b[r + 12 * _L],
        b[s + 13 * _L] + f * b[r + 13 * _L],
        b[s + 14 * _L] + f * b[r + 14 * _L],
    )


@njit
def put_sample(b: np.ndarray, sample: int, lane: int, values: np.ndarray, i: int) -> None:
    """Write a machine's sample of the inputs from outside, and the rise to the next one."""
    s, r = sample * _L + lane, (sample + RISE - SAMPLE) * _L + lane
    for k in range(values.shape[1]):
        b[s + k * _L] = values[i, k]
        b[r + k * _L] = values[i + 1, k] - values[i, k]


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


def side_by_side(series: Sequence[np.ndarray], behind: float) -> np.ndarray:
    """Series of different lengths in rows, filled up with a value. # each (n, ...) -> (series, longest, ...)."""
    rows = np.full((len(series), max(map(len, series)), *series[0].shape[1:]), behind)
    for row, values in zip(rows, series, strict=True):
        row[: len(values)] = values
    return rows


def filled_up(law: np.ndarray, count: int) -> np.ndarray:
    """A law with terms of no size. # (k,) -> (count,)."""
    terms = np.ones(count, dtype=LAW)  # what divides is not zero
    for name in ("sine", "cosine", "frequency", "probe", "time", "place", "speed_shape", "other"):
        terms[name] = 0.0
    terms[: len(law)] = law
    return terms
