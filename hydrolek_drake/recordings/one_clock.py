"""Signals that were sampled by clocks of their own, put on one."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.clock import usual_interval
from hydrolek_drake.recordings.columns import HELD_QUANTITIES, quantity_of
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.offset import Offset, offset_from_data, overlap
from hydrolek_drake.recordings.resampling import averaged, averaged_held, held, linear

MOTIONS = frozenset({"angle", "position", "pot", "rate", "velocity"})
"""Quantities by which a motion is compared: the clock of one of them is everybody's."""

_LIKE = 1.5
"""A clock this many times as fast as another is sampled, not averaged: there is little between its samples."""

_ROUNDING = 1e-3
"""What is set this share of a step after a tick is set at it: times of the two are rounded."""


@dataclass(frozen=True)
class Sampled:
    """A signal with its own clock.

    Attributes:
        clock: Name of the clock, for messages: a topic, a group of channels.
        time: Strictly increasing [s]. # (n,)
        values: In SI units. # (n,)
    """

    clock: str
    time: np.ndarray
    values: np.ndarray


def on_one_clock(
    signals: Mapping[str, Sampled], chosen: str | None, dead_time: float
) -> tuple[np.ndarray, dict[str, np.ndarray], list[Finding]]:
    """Put signals on the clock of the fastest motion sensor, or on the one that was chosen.

    Commands and references are held; where they are set faster than the one clock ticks, they are averaged
    from each tick to the next, which keeps what a valve integrates. Sensors are put on straight lines between
    their samples or, where they are faster, averaged around each tick, which keeps what is above half its
    rate from being taken for something slower. Where clocks differ, the offset between command and response
    is sought in the data: see `offset_from_data`.

    Args:
        signals: By key.
        chosen: Name of the clock that the rig names as time, if any.
        dead_time: By how much a motion follows its command [s], where an offset has to be removed.

    Returns:
        Time [s] # (n,), values of each signal at it # (n,) each, and what was done, in words.

    Raises:
        InputError: Two clocks have no time in common, and their offset cannot be found from the data.
    """
    clocks = {one.clock: one.time for one in signals.values()}
    base = chosen if chosen in clocks else _base(signals)
    shifts, findings = _shifts(signals, base, dead_time)
    time = clocks[base] + shifts.get(base, 0.0)
    step = usual_interval(time)
    on_it: dict[str, np.ndarray] = {}
    for key, one in signals.items():
        own = one.time + shifts.get(one.clock, 0.0)
        if one.clock == base:
            on_it[key] = one.values
            continue
        is_held = quantity_of(key) in HELD_QUANTITIES
        if own.size > 1 and step > _LIKE * usual_interval(own):
            edges = (
                np.append(time, time[-1] + step)
                if is_held
                else np.append(time - step / 2, time[-1] + step / 2)
            )
            on_it[key] = (averaged_held if is_held else averaged)(own, one.values, edges)
            way = "averaged over its steps"
        else:
            on_it[key] = (
                held(own, one.values, time + _ROUNDING * step) if is_held else linear(own, one.values, time)
            )
            way = "held" if is_held else "put on straight lines between its samples"
        rate = f"{1.0 / usual_interval(own):.4g} Hz" if own.size > 1 else "one sample"
        slow = not is_held and own.size > 1 and usual_interval(own) > _LIKE * step
        message = (
            f"{key} ({one.clock}, {rate}) is put on the clock of {base} ({1.0 / step:.4g} Hz): {way}"
            + ("; its noise shows too small there" if slow else "")
        )
        findings.append(Finding("resampled", key, message, ((float(time[0]), float(time[-1])),)))
    return time, on_it, findings


def _base(signals: Mapping[str, Sampled]) -> str:
    """The clock that ticks fastest of those of motions; without any, of sensors; without any, of all."""

    def rank(key: str) -> tuple[int, float]:
        quantity, time = quantity_of(key), signals[key].time
        kind = 0 if quantity in MOTIONS else 2 if quantity in HELD_QUANTITIES else 1
        return kind, usual_interval(time) if time.size > 1 else np.inf

    return signals[min(signals, key=rank)].clock


def _shifts(
    signals: Mapping[str, Sampled], base: str, dead_time: float
) -> tuple[dict[str, float], list[Finding]]:
    """By how much each clock has to be moved [s], and the sentences about it."""
    command = next((key for key in signals if quantity_of(key) == "command"), None)
    anchor = signals[command].clock if command else base
    times = {one.clock: one.time for one in signals.values()}
    shifts: dict[str, float] = {}
    findings: list[Finding] = []
    for clock, time in times.items():
        if clock == anchor:
            continue
        found = _offset(signals, clock, anchor)
        if found is None:
            if overlap(times[anchor], time) <= 0.0:
                raise InputError(
                    f"the clocks of {anchor} ({_span(times[anchor])}) and {clock} ({_span(time)}) have no time in "
                    "common, and no motion that follows the command tells how they lie; map signals of one clock"
                )
            continue
        what, offset = found
        if offset.plausible:
            message = (
                f"{what} follows its command by {offset.lag:.3g} s (correlation {offset.correlation:.2f}); they "
                "have clocks of their own, so a part of it may be an offset between them: a fit takes it for dead time"
            )
        else:
            shifts[clock] = dead_time - offset.lag
            message = (
                f"the clock of {clock} is moved by {shifts[clock]:+.6g} s: {what} would follow its command by "
                f"{offset.lag:.6g} s (correlation {offset.correlation:.2f}); dead time is then {dead_time:g} s by "
                "assumption, the recording does not tell it"
            )
        findings.append(Finding("offset", None, message, ((float(time[0]), float(time[-1])),)))
    if base != anchor and base in shifts:  # the one clock stays as it was recorded; the others come to it
        moved = shifts[base]
        shifts = {clock: shifts.get(clock, 0.0) - moved for clock in times}
    return shifts, findings


def _offset(signals: Mapping[str, Sampled], clock: str, anchor: str) -> tuple[str, Offset] | None:
    """The offset that the clearest of a clock's signals tells, and which that is."""
    best: tuple[str, Offset] | None = None
    for key, one in signals.items():
        if one.clock != clock or quantity_of(key) in HELD_QUANTITIES or one.time.size < 3:
            continue
        joint = key.rpartition(".")[0]
        command = signals.get(f"{joint}.command")
        if command is None or command.clock != anchor or command.time.size < 3:
            continue
        rates = quantity_of(key) in ("rate", "velocity") or quantity_of(key) not in MOTIONS
        found = offset_from_data(command.time, command.values, one.time, one.values, is_rate=rates)
        if found and (best is None or found.correlation > best[1].correlation):
            best = (key, found)
    return best


def _span(time: np.ndarray) -> str:
    return f"{time[0]:.9g} s to {time[-1]:.9g} s"
