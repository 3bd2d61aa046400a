"""Control laws as a Drake system: one block for all joints of a rig."""

from collections.abc import Sequence

import numpy as np
from pydrake.systems.framework import Context, LeafSystem, State

from hydrolek_drake.control.laws.law import ControlLaw


class Controller(LeafSystem):
    """Sampled controllers of n joints.

    Each law's difference equation is run once a sample; the voltage is held in between. The update comes
    before those of sampled plants at the same time, so a plant sees the voltage of this sample.

    Ports:
        in `set_point` (n): wanted positions [rad]; NaN withdraws a joint's set point. For joystick rate control
            `deflection` (n) [percent] stands in its place, and for forces `force_wanted` (n) [N].
        in `position_measured` (n) [rad]; for forces `force_measured` (n) [N].
        out `command` (n): voltages [V], 0 before the first sample.
        out `controller_output` (n): in the unit of each law's input element.
    """

    def __init__(
        self, laws: Sequence[ControlLaw], sample_s: float, *, joystick: bool = False, force: bool = False
    ):
        """Build for the joints' laws.

        Args:
            laws: one per joint.
            sample_s: their sample time [s].
            joystick: the laws are `RateLaw`s (guarded or not), led by deflections instead of set points.
            force: the laws are `GripForceLaw`s, led by forces and fed with them.
        """
        super().__init__()
        self.set_name("rate_controller" if joystick else "force_controller" if force else "controller")
        self._to_law = 1.0 if joystick or force else float(np.degrees(1.0))
        self._of_measured = 1.0 if force else float(np.degrees(1.0))
        self._laws = tuple(laws)
        n = len(self._laws)
        led_by = "deflection" if joystick else "force_wanted" if force else "set_point"
        self.set_point = self.DeclareVectorInputPort(led_by, n)
        self.measured = self.DeclareVectorInputPort("force_measured" if force else "position_measured", n)
        self._states = [self.DeclareDiscreteState(law.initial(0.0)) for law in self._laws]
        self._begun = self.DeclareDiscreteState(np.zeros(1))
        self._voltage = self.DeclareDiscreteState(np.zeros(n))
        self._output = self.DeclareDiscreteState(np.zeros(n))
        self.DeclarePeriodicUnrestrictedUpdateEvent(sample_s, 0.0, self._update)
        self.command = self.DeclareStateOutputPort("command", self._voltage)
        self.output = self.DeclareStateOutputPort("controller_output", self._output)

    def _update(self, context: Context, state: State) -> None:
        values = state.get_mutable_discrete_state()
        wanted = self._to_law * self.set_point.Eval(context)
        measured = self._of_measured * self.measured.Eval(context)
        begun = bool(values.get_value(self._begun)[0])
        voltages, outputs = np.zeros(len(self._laws)), np.zeros(len(self._laws))
        for i, law in enumerate(self._laws):
            before = values.get_value(self._states[i]).copy() if begun else law.initial(measured[i])
            after, outputs[i], voltages[i] = law.step(before, wanted[i], measured[i])
            values.get_mutable_vector(self._states[i]).SetFromVector(after)
        values.get_mutable_vector(self._begun).SetFromVector(np.ones(1))
        values.get_mutable_vector(self._voltage).SetFromVector(voltages)
        values.get_mutable_vector(self._output).SetFromVector(outputs)
