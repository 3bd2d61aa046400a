"""The model inside an exported unit, whichever version of FMI asks for it."""

import json
from pathlib import Path

import numpy as np
import yaml

from hydrolek_drake.fmu.variables import INPUT, PARAMETER, variables_of
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.onwards import JointOnwards, JointsOnwards, onwards

RIG_FILE, ASKED_FILE = "rig.yaml", "asked.json"
"""Files among a unit's resources: the rig, and what of it is there, how it is called, and steps that simulators take
unless told otherwise."""

_OFF = 1e-6
"""A step that begins by more than this share of its length elsewhere than the last one ended is no continuation."""


def resources(rig: Rig, joints: list[str], title: str, step_size: float, stop_time: float) -> dict[str, str]:
    """Contents of the files that `Model` reads, by their names."""
    tree = yaml.safe_dump(rig.as_tree(), sort_keys=False, allow_unicode=True)
    asked = {"joints": joints, "title": title, "step_size": step_size, "stop_time": stop_time}
    return {RIG_FILE: tree, ASKED_FILE: json.dumps(asked)}


class Model:
    """Values of all variables of a unit, and the machine that moves them.

    Attributes:
        variables: name -> variable.
        title: one line for people.
        step_size: that simulators take unless told otherwise [s].
        stop_time: when they end unless told otherwise [s].
    """

    def __init__(self, folder: str | Path) -> None:
        """Read what `resources` gave.

        Args:
            folder: where the unit's resources are unpacked.

        Raises:
            InputError: the rig cannot be read or rolled out.
        """
        asked = json.loads((Path(folder) / ASKED_FILE).read_text())
        self._rig = load_rig(str(Path(folder) / RIG_FILE), {})
        self._joints: list[str] = asked["joints"]
        self.title: str = asked["title"]
        self.step_size, self.stop_time = float(asked["step_size"]), float(asked["stop_time"])
        self.variables = {each.name: each for each in variables_of(self._rig, self._joints)}
        self._values = {
            each.name: self._rig.value(
                f"joints.{each.joint}."
                + ("command.neutral" if each.causality == INPUT else "load.initial_position")
            )
            for each in self.variables.values()
            if each.causality in (INPUT, PARAMETER)
        }
        self._machines: list[JointOnwards | JointsOnwards] = []
        self._told: dict[str, np.ndarray] = {}

    def value(self, name: str) -> float:
        """Present value of a variable; at rest where nothing has begun yet."""
        variable = self.variables[name]
        if variable.causality in (INPUT, PARAMETER):
            return self._values[name]
        if not self._told:
            self.begin(0.0)
        return float(self._told[variable.joint][SIGNALS.index(variable.signal)])

    def put(self, name: str, value: float) -> None:
        """Give a command or a parameter its value; parameters count when the machine begins."""
        self._values[name] = float(value)

    def begin(self, time: float) -> None:
        """Put the machine at rest and switch it on at a time [s]."""
        starts = {
            each.joint: self._values[each.name]
            for each in self.variables.values()
            if each.causality == PARAMETER
        }
        self._machines = onwards(self._rig, self._joints, time, starts)
        self._tell()

    def step(self, time: float, step: float) -> None:
        """Hold the commands over a step.

        Args:
            time: where it begins, which is where the last one ended [s].
            step: its length [s].

        Raises:
            InputError: the machine leaves all bounds.
            ValueError: the step begins elsewhere.
        """
        for machine in self._machines:
            if abs(machine.time - time) > _OFF * step:
                raise ValueError(f"the step begins at {time:g} s, but the model is at {machine.time:g} s")
            volts = np.array([self._volts(joint) for joint in machine.joints])
            if time + step > machine.time:
                machine.advance(volts, time + step)
        self._tell()

    def _volts(self, joint: str) -> float:
        """Command of a joint [V]; joints of an arm that nobody commands give way on their oil."""
        name = f"{joint}.command"
        return (
            self._values[name] if name in self._values else self._rig.value(f"joints.{joint}.command.neutral")
        )

    def _tell(self) -> None:
        self._told = {
            joint: machine.signals[i] for machine in self._machines for i, joint in enumerate(machine.joints)
        }
