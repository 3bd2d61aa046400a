"""What a scenario commands: each kind gives a table of values over time, each held until the next."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording, require
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import recorded_inputs, with_commands
from hydrolek_drake.rigs.parameters.keys import refuse_unknown
from hydrolek_drake.scenarios.fields import joints_of, number, quantity, required, signal, steps
from hydrolek_drake.scenarios.set_points import KIND, Controlled, parse_controlled
from hydrolek_drake.systems.recorded import Recorded

KINDS = ("constant", "steps", "random", "recording", KIND)
_MOST_LEVELS = 100_000  # finer than any converter


class Command(Protocol):
    """Something that drives the joints of a rig."""

    def table(self, duration: float, period: float, seed: int | None) -> tuple[np.ndarray, np.ndarray]:
        """Times [s], shape (m,), beginning at 0, and values [V, or % with an operator], shape (m, joints).

        Args:
            duration: of the run [s].
            period: at which signals are written [s]; random changes fall on its multiples, so that the
                written command is exactly the one that acted.
            seed: of random commands; None for the scenario's own.
        """
        ...


@dataclass(frozen=True)
class Steps:
    """Given values from given times on; a constant command is a single one.

    Attributes:
        rows: per joint of the rig, times [s] and values.
        rest: what each joint is given before its first time, shape (joints,).
    """

    rows: tuple[tuple[tuple[float, float], ...], ...]
    rest: np.ndarray

    def table(self, duration: float, period: float, seed: int | None) -> tuple[np.ndarray, np.ndarray]:
        """See `Command`."""
        times = np.unique([0.0, duration, *(time for rows in self.rows for time, _ in rows)])
        values = np.tile(self.rest, (len(times), 1))
        for joint, rows in enumerate(self.rows):
            for time, value in rows:
                values[times >= time, joint] = value
        return times, values


@dataclass(frozen=True)
class RandomLevels:
    """Multi-level random values, as the thesis's identification experiments use (section 6.1.4).

    Attributes:
        driven: which joints of the rig move, shape (joints,).
        rest: what the others are given, shape (joints,).
        amplitude: largest level away from rest.
        levels: how many equally spaced levels there are from -amplitude to amplitude.
        hold: shortest and longest time that a level is held [s].
        seed: of the scenario.
    """

    driven: np.ndarray
    rest: np.ndarray
    amplitude: float
    levels: int
    hold: tuple[float, float]
    seed: int

    def table(self, duration: float, period: float, seed: int | None) -> tuple[np.ndarray, np.ndarray]:
        """See `Command`; every joint draws from a stream of its own."""
        streams = np.random.default_rng(self.seed if seed is None else seed).spawn(len(self.rest))
        choices = np.linspace(-self.amplitude, self.amplitude, self.levels)
        rows: list[tuple[tuple[float, float], ...]] = []
        for joint, stream in enumerate(streams):
            drawn: list[tuple[float, float]] = []
            count = 0
            while self.driven[joint] and count * period < duration:
                drawn.append((count * period, float(self.rest[joint] + stream.choice(choices))))
                count += max(round(float(stream.uniform(*self.hold)) / period), 1)
            rows.append(tuple(drawn))
        return Steps(tuple(rows), self.rest).table(duration, period, None)


@dataclass(frozen=True)
class Playback:
    """The commands of a recording, from its first sample on.

    Attributes:
        times: [s], from 0, shape (m,).
        values: [V], shape (m, joints).
        recorded: what is recorded in place of a part of the model, where the rig is driven by it.
    """

    times: np.ndarray
    values: np.ndarray
    recorded: Recorded | None = None

    def table(self, duration: float, period: float, seed: int | None) -> tuple[np.ndarray, np.ndarray]:
        """See `Command`."""
        return self.times, self.values


def parse_command(raw: Any, rig: Rig, where: str, folder: Path) -> tuple[Command | Controlled, bool]:
    """The command of a scenario or its controllers, and whether it is signals in percent for the operator computer.

    Args:
        raw: the scenario's `command`.
        rig: names the joints.
        where: file and key, for errors.
        folder: of the scenario, where a recording's path begins.

    Raises:
        InputError: unknown kind, key or joint, wrong value or unit, or a recording without the commands.
    """
    if not isinstance(raw, Mapping):
        raise InputError(f"{where} must be a mapping with kind: {', '.join(KINDS)}")
    kind = raw.get("kind")
    if kind == KIND:
        return parse_controlled(raw, rig, where, folder), False
    operator = raw.get("operator", False)
    if not isinstance(operator, bool):
        raise InputError(f"{where}.operator: '{operator}' is neither true nor false")
    rest = np.zeros(len(rig.joints)) if operator else rig.records()["command"]["neutral"].astype(float)
    if kind == "recording":
        refuse_unknown(raw, ("kind", "path"), where)
        return _playback(folder / str(required(raw, "path", where)), rig, where), False
    if kind == "random":
        return _random(raw, rig, rest, operator, where), operator
    if kind not in ("constant", "steps"):
        raise InputError(f"{where}.kind: '{kind}' is unknown; choose {', '.join(KINDS)}")
    refuse_unknown(raw, ("kind", "operator", "joints"), where)
    given = joints_of(required(raw, "joints", where), rig, f"{where}.joints")
    rows: list[tuple[tuple[float, float], ...]] = []
    for joint in rig.joints:
        key = f"{where}.joints.{joint}"
        if joint not in given:
            rows.append(())
        elif kind == "constant":
            rows.append(((0.0, _value(given[joint], operator, key)),))
        else:
            rows.append(steps(given[joint], key, "2 V", lambda value, at: _value(value, operator, at)))
    return Steps(tuple(rows), rest), operator


def _random(raw: Mapping[str, Any], rig: Rig, rest: np.ndarray, operator: bool, where: str) -> RandomLevels:
    refuse_unknown(raw, ("kind", "operator", "joints", "amplitude", "levels", "hold", "seed"), where)
    names = raw.get("joints", list(rig.joints))
    if not isinstance(names, list):
        raise InputError(f"{where}.joints: '{names}' must be a list of joints from {', '.join(rig.joints)}")
    joints_of(dict.fromkeys(map(str, names)), rig, f"{where}.joints")
    hold = required(raw, "hold", where)
    if not isinstance(hold, list) or len(hold) != 2:
        raise InputError(f"{where}.hold: '{hold}' must be [shortest, longest], such as [0.2 s, 1 s]")
    shortest, longest = (quantity(value, "s", f"{where}.hold", lowest=0.0) for value in hold)
    if not 0.0 < shortest <= longest:
        raise InputError(f"{where}.hold: {hold} must run from a shorter to a longer time above 0 s")
    amplitude = _value(required(raw, "amplitude", where), operator, f"{where}.amplitude")
    if amplitude <= 0.0:
        raise InputError(f"{where}.amplitude: {amplitude:g} must be above 0")
    return RandomLevels(
        np.array([joint in names for joint in rig.joints]),
        rest,
        amplitude,
        number(required(raw, "levels", where), f"{where}.levels", lowest=2, highest=_MOST_LEVELS),
        (shortest, longest),
        number(raw.get("seed", 0), f"{where}.seed", lowest=0),
    )


def _playback(path: Path, rig: Rig, where: str) -> Playback:
    try:
        recording = with_commands(rig, read_recording(path, rig.columns, dead_time=rig.dead_time))
        keys = [f"{joint}.command" for joint in rig.joints]
        require(recording, keys, complete=keys, units=dict.fromkeys(keys, "V"))
        inputs = [recorded_inputs(rig, joint, recording) for joint in rig.joints]
    except InputError as error:
        raise InputError(f"{where}.path: {error}") from None
    values = np.column_stack([recording.signal(key) for key in keys])
    recorded = Recorded(inputs) if rig.driven_by else None
    return Playback(recording.time - recording.time[0], values, recorded)


def _value(raw: Any, operator: bool, where: str) -> float:
    return signal(raw, where) if operator else quantity(raw, "V", where)
