"""The operator computer: signals in percent to calibrated voltages on the field point's channels."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.command import CALIBRATED, calibrated_voltages

CHANNELS_PER_MODULE = 8


@njit(cache=True)
def _voltages(
    joints: np.ndarray, signal: np.ndarray, place_a: np.ndarray, place_b: np.ndarray, out: np.ndarray
) -> None:
    for i in range(len(joints)):
        out[place_a[i]], out[place_b[i]] = calibrated_voltages(signal[i], joints[i])


def channel_places(joints: np.ndarray, first_module: int) -> tuple[np.ndarray, np.ndarray]:
    """Where each joint's two channels stand in the field point's output, Table 3.1."""
    command = joints["command"]
    start = (command["module"].astype(int) - first_module) * CHANNELS_PER_MODULE
    return start + command["channel_a"].astype(int), start + command["channel_b"].astype(int)


class OperatorComputer(LeafSystem):
    """Calibrated voltages on the channels of Table 3.1, equations (4.2), (4.3).

    Ports:
        in `signal_commanded` (n): S_in per joint [%], -100 to 100, positive towards chamber A.
        out `channel_voltage` (8 per module): what the Compact Field Point puts on its channels [V].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,).

        Raises:
            InputError: a joint's command stage is not calibrated, or two joints share a channel.
        """
        super().__init__()
        self.set_name("operator_computer")
        if not np.all(joints["command"]["variant"] == CALIBRATED):
            raise InputError(
                "the operator computer needs joints.<joint>.command.variant: calibrated on every joint of the rig"
            )
        self._joints = joints
        self.first_module = int(joints["command"]["module"].min())
        modules = int(joints["command"]["module"].max()) - self.first_module + 1
        self._place_a, self._place_b = channel_places(joints, self.first_module)
        places = np.concatenate([self._place_a, self._place_b])
        if len(set(places.tolist())) < len(places):
            raise InputError(
                "two joints of the rig share a channel of the field point (command.module, channel_a, channel_b)"
            )
        self.signal = self.DeclareVectorInputPort("signal_commanded", len(joints))
        self.channels = self.DeclareVectorOutputPort(
            "channel_voltage", modules * CHANNELS_PER_MODULE, self._calc
        )

    def _calc(self, context: Context, output: BasicVector) -> None:
        voltages = np.zeros(output.size())
        _voltages(self._joints, self.signal.Eval(context), self._place_a, self._place_b, voltages)
        output.SetFromVector(voltages)


class FieldPoint(LeafSystem):
    """The Compact Field Point's wiring: two channels per joint become one signed voltage.

    Ports:
        in `channel_voltage` (8 per module) [V].
        out `command` (n): voltage per joint, positive towards chamber A [V].
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("field_point")
        first = int(joints["command"]["module"].min())
        modules = int(joints["command"]["module"].max()) - first + 1
        self._place_a, self._place_b = channel_places(joints, first)
        self.channels = self.DeclareVectorInputPort("channel_voltage", modules * CHANNELS_PER_MODULE)
        self.command = self.DeclareVectorOutputPort("command", len(joints), self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        voltage = self.channels.Eval(context)
        output.SetFromVector(voltage[self._place_a] - voltage[self._place_b])
