"""Physics in no list as a short law: what it adds at every stage."""

import numpy as np
from numba import njit
from pydrake.systems.framework import BasicVector, Context, InputPort, LeafSystem

from hydrolek_drake.physics.law import Seen, felt, law_of
from hydrolek_drake.physics.probes import PROBES, no_probe


@njit(cache=True)
def _outside(
    laws: np.ndarray,
    joint: int,
    motion: np.ndarray,
    rod: np.ndarray,
    pressure: np.ndarray,
    spool: np.ndarray,
    time: float,
    out: np.ndarray,
) -> None:
    """Write a joint's probes into its row of `out`."""
    n = len(out)
    seen = Seen(
        time,
        motion[joint],
        motion[n + joint],
        rod[joint],
        rod[n + joint],
        pressure[joint],
        pressure[n + joint],
        spool[joint],
    )
    added, _ = felt(no_probe(), laws, 0.0, seen)
    row = out[joint]
    row[0], row[1], row[2], row[3] = added.command, added.amplifier, added.valve, added.supply
    row[4], row[5], row[6], row[7] = added.cylinder, added.load, added.sensor, added.flow
    row[8], row[9] = added.capacity_a, added.capacity_b
    row[10], row[11] = added.back_a, added.back_b
    row[12], row[13], row[14] = added.ramp, added.coil_time, added.flow_force


class ShortLaw(LeafSystem):
    """The laws of the joints (see `physics.law`): unknown inputs of the stages from what the machine does.

    Ports:
        in `joint_motion` (2n): positions, then velocities of the joints.
        in `rod_motion` (2n): strokes, then velocities; open in a machine without oil, as the next two are.
        in `pressure` (2n): chambers A, then B [Pa].
        in `spool_position` (n) [m].
        out `outside` (15 n): `probes.PROBES` of the first joint, then of the next.
    """

    def __init__(self, joints: np.ndarray):
        """Build for the joints' records, shape (n,)."""
        super().__init__()
        self.set_name("short_law")
        n = len(joints)
        self._laws = {i: law for i in range(n) if (law := law_of(joints[i : i + 1])) is not None}
        self._none = np.zeros(2 * n)
        self.motion = self.DeclareVectorInputPort("joint_motion", 2 * n)
        self.rod = self.DeclareVectorInputPort("rod_motion", 2 * n)
        self.pressure = self.DeclareVectorInputPort("pressure", 2 * n)
        self.spool = self.DeclareVectorInputPort("spool_position", n)
        self._shape = (n, len(PROBES))
        self.outside = self.DeclareVectorOutputPort("outside", n * len(PROBES), self._calc)

    def _calc(self, context: Context, output: BasicVector) -> None:
        out = np.zeros(self._shape)
        motion = self.motion.Eval(context)
        rod, pressure, spool = (self._of(port, context) for port in (self.rod, self.pressure, self.spool))
        for joint, laws in self._laws.items():
            _outside(laws, joint, motion, rod, pressure, spool, context.get_time(), out)
        output.SetFromVector(out.ravel())

    def _of(self, port: InputPort, context: Context) -> np.ndarray:
        return port.Eval(context) if port.HasValue(context) else self._none


class Outside:
    """What a law adds, for the system that it acts in; zero where the port stays open.

    A stage declares the port as its last and reads it in its equations.
    """

    def __init__(self, system: LeafSystem, joints: int):
        """Declare the port `outside` (15 n) of a system."""
        self.port = system.DeclareVectorInputPort("outside", joints * len(PROBES))
        self._shape = (joints, len(PROBES))
        self._none = np.zeros(self._shape)

    def eval(self, context: Context) -> np.ndarray:
        """One row for each joint, `probes.PROBES`. # (n, 15)."""
        if not self.port.HasValue(context):
            return self._none
        return self.port.Eval(context).reshape(self._shape)
