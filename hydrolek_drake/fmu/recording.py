"""A recording of a unit that takes a machine's place."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.fmu.foreign import AT_MOST_S, Unit, play
from hydrolek_drake.fmu.wiring import listed, wired
from hydrolek_drake.recordings import Recording
from hydrolek_drake.recordings.requirements import require
from hydrolek_drake.replay.readings import position_key
from hydrolek_drake.rigs import Rig

_LARGEST = 50_000_000
"""Values of a recording at most: a sample time in the wrong unit would fill the memory."""

_EVEN = 0.1
"""Intervals of a clock that ticks evenly differ from their median by less than this share, as in `checks`."""


@dataclass(frozen=True)
class Sensors:
    """What sensors add to a unit's outputs.

    Attributes:
        noise: signal -> standard deviation, in its SI unit.
        resolution: signal -> step of its values, in its SI unit.
    """

    noise: Mapping[str, float] = field(default_factory=dict)
    resolution: Mapping[str, float] = field(default_factory=dict)

    def read(self, key: str, values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Values of a signal as a sensor has them."""
        noisy = values + self.noise.get(key, 0.0) * rng.standard_normal(values.size)
        step = self.resolution.get(key, 0.0)
        return np.round(noisy / step) * step if step > 0.0 else noisy


def sensors_of(rig: Rig) -> Sensors:
    """Noise and resolution that a rig states of its sensors."""
    noise, resolution = {}, {}
    for joint in rig.joints:
        own = f"joints.{joint}.sensor"
        noise[position_key(rig, joint)] = rig.value(f"{own}.noise")
        resolution[position_key(rig, joint)] = rig.value(f"{own}.resolution")
        noise[f"{joint}.current"] = rig.value(f"{own}.current_noise")
        for side in ("pressure_a", "pressure_b"):
            noise[f"{joint}.{side}"] = rig.value(f"{own}.pressure_noise")
    return Sensors(noise, resolution)


def record_unit(
    unit: Unit,
    command: Recording,
    rng: np.random.Generator,
    *,
    mapping: Mapping[str, str] | None = None,
    rig: Rig | None = None,
    sensors: Sensors | None = None,
    sample_time: float | None = None,
    start: Mapping[str, float] | None = None,
    at_most: float = AT_MOST_S,
) -> Recording:
    """Drive a unit with commands and record it.

    Commands are held from sample to sample, as those of a recording are when it is replayed.

    Args:
        unit: it.
        command: whose signals drive the inputs of the same names.
        rng: of the noise.
        mapping: variable of the unit -> name of the contract with unit.
        rig: whose names for columns are used too.
        sensors: what they add.
        sample_time: of the recording, and the unit's communication step [s]; None for the command's.
        start: variable -> value before it begins.
        at_most: time limit [s].

    Raises:
        InputError: nothing drives the unit or comes out of it, or it cannot be run, see `foreign.play`.
    """
    inputs, outputs = wired(unit, mapping or {}, rig.columns if rig is not None else {})
    driven = [wire for wire in inputs if wire.key in command.signals]
    if not driven:
        has = ", ".join(sorted(command.signals))
        raise InputError(
            f"{unit.path}: no input is a signal of {command.source}, which has {has}; map one, such as "
            f"--map VARIABLE=boom.command_V; its inputs are {listed(unit, 'input')}"
        )
    if not outputs:
        raise InputError(
            f"{unit.path}: no output is known as a signal; map one, such as --map VARIABLE=boom.angle_rad; its outputs "
            f"are {listed(unit, 'output')}"
        )
    for name in start or {}:
        if name not in unit.variables:
            raise InputError(f"{unit.path} has no variable '{name}' to be set")
    require(command, [], complete=[wire.key for wire in driven])
    for wire in driven:
        if command.units[wire.key] != wire.unit:
            raise InputError(
                f"{command.source}: signal {wire.key} is in {command.units[wire.key]}, input '{wire.variable}' in "
                f"{wire.unit}"
            )
    step = _step(command, sample_time)
    count = math.floor(command.duration / step + 1e-9) + 1
    if count < 2:
        raise InputError(f"--sample-time {step:g}: the command lasts {command.duration:g} s only")
    if count * (len(driven) + len(outputs)) > _LARGEST:
        raise InputError(f"--sample-time {step:g}: {count} samples are too many for one recording")
    times = command.time[0] + step * np.arange(count)
    held = command.resampled(times)
    commands = {wire.variable: held.signals[wire.key] / wire.factor for wire in driven}
    done = play(unit, commands, [w.variable for w in outputs], step, start=start, at_most=at_most)
    given = sensors or Sensors()
    signals = {wire.key: held.signals[wire.key] for wire in driven}
    for wire in outputs:
        values = wire.factor * done[wire.variable]
        if not np.isfinite(values).all():
            at = step * int(np.argmax(~np.isfinite(values)))
            raise InputError(f"{unit.path}: its output '{wire.variable}' is not finite at {at:g} s")
        signals[wire.key] = given.read(wire.key, values, rng)
    units = {wire.key: wire.unit for wire in (*driven, *outputs)}
    return Recording(unit.path.stem, times, signals, Path(unit.path), units=units)


def _step(command: Recording, sample_time: float | None) -> float:
    """The sample time [s]: the one that is asked for, or the command's."""
    if sample_time is not None:
        return sample_time
    intervals = np.diff(command.time)
    middle = float(np.median(intervals))
    even = np.abs(intervals - middle).max() < _EVEN * middle
    return command.duration / intervals.size if even else middle
