"""Scenarios that name a controller and where its joints are wanted: given in the file, or read from a recording."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, read_recording, require
from hydrolek_drake.recordings.resampling import held, linear
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.parameters.keys import refuse_unknown
from hydrolek_drake.scenarios.fields import joints_of, quantity, required, steps

if TYPE_CHECKING:
    from hydrolek_drake.control.loop_command import LoopCommand

KIND = "controlled"
_QUANTITIES = ("reference", "angle")  # what a column of set points is called, what is preferred first
_ROUNDING = 1e-9  # seconds by which a control sample may miss the time of a step


@dataclass(frozen=True)
class SetPoints:
    """Where one joint is wanted over time.

    Attributes:
        times: [s], increasing, shape (m,).
        values: [rad], shape (m,); NaN withdraws the set point.
        stepped: whether each holds until the next; else a straight line joins them, but for gaps of the recording.
        end: when they are withdrawn [s].
    """

    times: np.ndarray
    values: np.ndarray
    stepped: bool
    end: float = np.inf

    def at(self, times: np.ndarray) -> np.ndarray:
        """Set points at other times [rad], shape of `times`: the last one holds on; NaN before the first."""
        # rounding must not make a step a sample late, nor give what comes after the last of them no value
        late = np.minimum(times + _ROUNDING, self.times[-1]) if self.times.size > 1 else times + _ROUNDING
        values = (held if self.stepped or self.times.size == 1 else linear)(self.times, self.values, late)
        return np.where(times >= self.end - _ROUNDING, np.nan, values)


@dataclass(frozen=True)
class Controlled:
    """Controllers with their set points.

    Attributes:
        controllers: by joint, names of the catalogue of controllers.
        set_points: by joint.
    """

    controllers: Mapping[str, str]
    set_points: Mapping[str, SetPoints]

    def until(self, time: float) -> "Controlled":
        """The same with all set points withdrawn from a time [s] on."""
        return replace(
            self, set_points={joint: replace(points, end=time) for joint, points in self.set_points.items()}
        )

    def table_deg(self, duration: float, sample_s: float) -> np.ndarray:
        """Set points at the control samples of a run [deg], one column a joint."""
        samples = np.arange(max(int(np.ceil(duration / sample_s - _ROUNDING)), 1)) * sample_s
        return np.degrees(np.column_stack([points.at(samples) for points in self.set_points.values()]))

    def command(self, rig: Rig, duration: float, noisy: bool) -> tuple[Rig, "LoopCommand", bool]:
        """What commands a station of the rig.

        Args:
            rig: the machine.
            duration: of the run [s].
            noisy: whether its sensors have noise.

        Returns:
            The rig as the controllers drive it, the controllers, and whether they give signals in percent.

        Raises:
            InputError: a joint for which no controller can be built.
        """
        # only such a scenario has need of controllers, which take a while to load
        from hydrolek_drake.control.catalogue import build_law, rig_setting
        from hydrolek_drake.control.laws.operator_path import through_operator_computer
        from hydrolek_drake.control.loop_command import loop_command
        from hydrolek_drake.control.thesis_gains import sample_s

        laws = {
            joint: build_law(name, rig_setting(rig, joint), noisy=noisy)
            for joint, name in self.controllers.items()
        }
        machine, signal_per_volt = through_operator_computer(rig)
        table = self.table_deg(duration, sample_s())
        loop = loop_command(machine, laws, table, sample_s(), signal_per_volt)
        return machine, loop, signal_per_volt is not None


def parse_controlled(raw: Mapping[str, Any], rig: Rig, where: str, folder: Path) -> Controlled:
    """Controllers and set points of a scenario.

    Args:
        raw: the scenario's `command`.
        rig: names the joints.
        where: file and key, for errors.
        folder: of the scenario, where a recording's path begins.

    Raises:
        InputError: unknown controller or joint, no set points, or a recording without them.
    """
    from hydrolek_drake.control.catalogue import CONTROLLERS  # see `Controlled.command`

    refuse_unknown(raw, ("kind", "controller", "joints"), where)
    given = joints_of(required(raw, "joints", where), rig, f"{where}.joints")
    if not given:
        raise InputError(
            f"{where}.joints: no joint has set points; name one or more of {', '.join(rig.joints)}"
        )
    named = required(raw, "controller", where)
    names = {}
    for joint in given:
        key = f"{where}.controller"
        if isinstance(named, Mapping):
            for other in named:
                if other not in given:
                    raise InputError(
                        f"{key}.{other}: that joint has no set points; give it some in {where}.joints"
                    )
            names[joint] = required(named, joint, key)
            key = f"{key}.{joint}"
        else:
            names[joint] = named
        if not isinstance(names[joint], str) or names[joint] not in CONTROLLERS:
            raise InputError(f"{key}: '{names[joint]}' is no controller; choose {', '.join(CONTROLLERS)}")
        if rig.variant(joint, "load") == "sliding":
            raise InputError(f"{where}.joints.{joint}: no turning joint; the controllers need one")
    read: dict[Path, Recording] = {}
    return Controlled(
        names,
        {
            joint: _set_points(given[joint], joint, rig, f"{where}.joints.{joint}", folder, read)
            for joint in given
        },
    )


def _set_points(
    raw: Any, joint: str, rig: Rig, where: str, folder: Path, read: dict[Path, Recording]
) -> SetPoints:
    if isinstance(raw, list):
        rows = steps(raw, where, "40 deg", lambda value, at: quantity(value, "rad", at))
        times, values = np.array(rows, dtype=float).T
        return SetPoints(times, values, stepped=True)
    if not isinstance(raw, Mapping):
        return SetPoints(np.zeros(1), np.array([quantity(raw, "rad", where)]), stepped=True)
    refuse_unknown(raw, ("recording", "signal"), where)
    path = folder / str(required(raw, "recording", where))
    try:
        if path not in read:
            read[path] = read_recording(path, rig.columns, dead_time=rig.dead_time)
        recording = read[path]
        keys = [f"{joint}.{name}" for name in _QUANTITIES]
        key = str(raw.get("signal", next((each for each in keys if each in recording.signals), keys[0])))
        require(recording, [key], units={key: "rad"})
    except InputError as error:
        raise InputError(f"{where}.recording: {error}") from None
    values = recording.signal(key)
    if not np.isfinite(values).any():
        raise InputError(f"{where}.recording: {path}: signal {key} has no value at any time")
    return SetPoints(recording.time - recording.time[0], values, key.endswith(".reference"))
