"""The potentiometers: what the control computer reads of each joint."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from hydrolek_drake.compiled import read_only
from hydrolek_drake.physics.probes import SENSOR
from hydrolek_drake.physics.sensor import played, potentiometer_voltage, reading
from hydrolek_drake.systems.short_law import Outside


@njit(cache=True)
def _follow(joints: np.ndarray, held: np.ndarray, motion: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(joints)):
        out[i] = played(held[i], motion[i], joints[i])


@njit(cache=True)
def _readings(
    joints: np.ndarray,
    held: np.ndarray,
    motion: np.ndarray,
    outside: np.ndarray,
    time: float,
    noise: np.ndarray,
    out: np.ndarray,
) -> None:
    for i in range(len(joints)):
        joint = joints[i]
        value = reading(played(held[i], motion[i], joint), time, joint) + outside[i, SENSOR]
        value += noise[i] * joint.sensor.noise
        if joint.sensor.resolution > 0.0:
            value = np.round(value / joint.sensor.resolution) * joint.sensor.resolution
        out[i] = value


@njit(cache=True)
def _voltages(joints: np.ndarray, reading_deg: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(joints)):
        out[i] = potentiometer_voltage(reading_deg[i], joints[i])


class Potentiometer(LeafSystem):
    """Joint positions as read, equations (3.1) to (3.3) and Table 3.2, with noise and resolution.

    Ports:
        in `motion` (2n): joint positions, then velocities.
        in `outside` (15 n): what a law adds, or open.
        out `position_measured` (n) [rad or m].
        out `position_ideal` (n): the same without noise and resolution; ground truth of the sensor's errors.
        out `potentiometer_voltage` (n) [V]; NaN for a joint without a potentiometer.
    """

    def __init__(self, joints: np.ndarray, step: float, generator: np.random.Generator | None):
        """Build for the joints' records.

        Args:
            joints: shape (n,).
            step: the diagram's step [s]; noise is drawn anew in each.
            generator: source of the noise; None for a sensor without noise and resolution.
        """
        super().__init__()
        self.set_name("potentiometer")
        n = len(joints)
        self._joints = joints if generator is not None else _without_resolution(joints)
        self._ideal = _without_resolution(joints)
        self._generator = generator
        self._silent = read_only(np.zeros(n))
        self.motion = self.DeclareVectorInputPort("motion", 2 * n)
        self.outside = Outside(self, n)
        self._held = self.DeclareDiscreteState(np.zeros(n))
        self._noise = self.DeclareDiscreteState(np.zeros(n))
        if generator is not None or np.any(joints["effects"]["sensor_hysteresis"]["half_width_rad"] > 0.0):
            self.DeclarePeriodicDiscreteUpdateEvent(step, 0.0, self._update)
        self.measured = self.DeclareVectorOutputPort("position_measured", n, self._calc)
        self.ideal = self.DeclareVectorOutputPort("position_ideal", n, self._calc_ideal)
        self.voltage = self.DeclareVectorOutputPort("potentiometer_voltage", n, self._calc_voltage)

    def _update(self, context: Context, values: DiscreteValues) -> None:
        held = context.get_discrete_state(self._held).get_value()
        following = np.empty(len(held))
        _follow(self._joints, held, self.motion.Eval(context), following)
        values.get_mutable_vector(self._held).SetFromVector(following)
        if self._generator is not None:
            values.get_mutable_vector(self._noise).SetFromVector(self._generator.standard_normal(len(held)))

    def _read(self, context: Context, joints: np.ndarray, noise: np.ndarray) -> np.ndarray:
        held = context.get_discrete_state(self._held).get_value()
        values = np.empty(len(held))
        motion, outside = self.motion.Eval(context), self.outside.eval(context)
        _readings(joints, held, motion, outside, context.get_time(), noise, values)
        return values

    def _calc(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(
            self._read(context, self._joints, context.get_discrete_state(self._noise).get_value())
        )

    def _calc_ideal(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._read(context, self._ideal, self._silent))

    def _calc_voltage(self, context: Context, output: BasicVector) -> None:
        reading_deg = np.degrees(self.measured.Eval(context))
        voltage = np.empty(len(self._joints))
        _voltages(self._joints, reading_deg, voltage)
        output.SetFromVector(voltage)


def _without_resolution(joints: np.ndarray) -> np.ndarray:
    ideal = joints.copy()
    ideal["sensor"]["resolution"] = 0.0
    return ideal
