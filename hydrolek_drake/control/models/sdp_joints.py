"""SDP models of a machine's joints as a Drake system: the plant of chapter 6."""

from collections.abc import Sequence

import numpy as np
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from hydrolek_drake.control.models.sdp_model import SdpModel
from hydrolek_drake.errors import InputError

_LATE = 1e-6  # seconds by which the models' samples come late, so that rounding never puts them before the controller's


class SdpJoints(LeafSystem):
    """Joints that move by their SDP models, thesis equation (6.2), each by itself.

    Ports:
        in `command` (n): voltages [V].
        out `position_measured` (n): angles [rad], ideal.
    """

    def __init__(self, models: Sequence[SdpModel], initial_deg: Sequence[float] | None = None):
        """Build for one model per joint.

        Args:
            models: all of one sample time.
            initial_deg: where the joints start; None for 0.

        Raises:
            InputError: the models' sample times differ.
        """
        super().__init__()
        self.set_name("sdp_joints")
        self._models = tuple(models)
        samples = {model.sample_s for model in self._models}
        if len(samples) != 1:
            raise InputError(f"SDP models of one system need one sample time; got {sorted(samples)} s")
        n = len(self._models)
        self.command = self.DeclareVectorInputPort("command", n)
        self._angle = self.DeclareDiscreteState(np.zeros(n) if initial_deg is None else np.array(initial_deg))
        # one line of past voltages per joint, newest first, as long as the delay less the sample under way
        self._lines = [
            self.DeclareDiscreteState(np.zeros(max(model.delay_samples - 1, 1))) for model in self._models
        ]
        self.DeclarePeriodicDiscreteUpdateEvent(samples.pop(), _LATE, self._update)
        self.measured = self.DeclareVectorOutputPort(
            "position_measured", n, self._calc, {self.discrete_state_ticket(self._angle)}
        )

    def _update(self, context: Context, values: DiscreteValues) -> None:
        command = self.command.Eval(context)
        angles = context.get_discrete_state(self._angle).get_value().copy()
        for i, model in enumerate(self._models):
            line = context.get_discrete_state(self._lines[i]).get_value()
            delayed = command[i] if model.delay_samples <= 1 else line[-1]
            angles[i] = model.step(angles[i], float(delayed))
            values.get_mutable_vector(self._lines[i]).SetFromVector(np.concatenate([[command[i]], line[:-1]]))
        values.get_mutable_vector(self._angle).SetFromVector(angles)

    def _calc(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(np.radians(context.get_discrete_state(self._angle).get_value()))
