"""The right arm as chapter 6's models of its joints, in place of the hydraulic machine."""

from dataclasses import replace

import numpy as np

from hydrolek_drake.control.catalogue import build_law, joystick_law
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.hydraulic_arms import JOINTS
from hydrolek_drake.workcell.grasp import tool_in_world
from hydrolek_drake.workcell.loose_pipe import clasped
from hydrolek_drake.workcell.pipe import workcell_entries


class SdpArms:
    """Right arm by SDP models under the same laws, with the interface of `HydraulicArms`; the left one stands.

    The jaw stops where it would touch the pipe; nothing else is touched.
    """

    def __init__(self, posture: np.ndarray, pipe, settings: dict) -> None:
        self._pipe = pipe
        mine = [settings[joint] for joint in JOINTS[:7]]
        stop = workcell_entries()["place"]["touching_deg"]
        mine[6] = replace(mine[6], model=replace(mine[6].model, lower_deg=float(stop)))
        self._models = [setting.model for setting in mine]
        self._lines = [[0.0] * model.delay_samples for model in self._models]
        self._laws = {
            "set_point": [build_law("feedforward", setting, noisy=False) for setting in mine],
            "deflection": [joystick_law(setting, noisy=False) for setting in mine],
        }
        self._posture = np.degrees(posture)
        self._states = {
            kind: [law.initial(angle) for law, angle in zip(laws, self._posture, strict=False)]
            for kind, laws in self._laws.items()
        }

    def advance(self, set_point=None, deflection=None) -> np.ndarray:
        wanted = {
            "set_point": None if set_point is None else np.degrees(set_point),
            "deflection": deflection,
        }
        for i, model in enumerate(self._models):
            voltage = 0.0
            for kind, laws in self._laws.items():
                value = np.nan if wanted[kind] is None else wanted[kind][i]
                state, _, own = laws[i].step(self._states[kind][i], value, self._posture[i])
                self._states[kind][i], voltage = state, voltage + own
            for _ in range(round(sample_s() / model.sample_s)):
                self._lines[i].append(voltage)
                self._posture[i] = model.step(self._posture[i], self._lines[i].pop(0))
        return self.position()

    def position(self) -> np.ndarray:
        return np.radians(self._posture)

    def touch(self) -> np.ndarray:
        return np.zeros(2)

    def grip(self) -> np.ndarray:
        return np.zeros(2)

    def held(self) -> bool:
        _, tool = tool_in_world(self.position(), "right")
        tolerance = np.radians(teleop_entries("task")["tolerance_deg"])
        return clasped(self._pipe, tool, self.position()[6] - tolerance)
