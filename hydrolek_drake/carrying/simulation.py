"""Both arms of the full hydraulic plant move one pipe that both grippers hold; how far the chain is from closed."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.carrying.plan import CarryPlan, carry_entries, pose_of
from hydrolek_drake.control.catalogue import JointSetting
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.teleop.controllers.hydraulic_arms import JOINTS, HydraulicArms
from hydrolek_drake.workcell.closed_chain import chain_error, follow, hold_at, tools_at
from hydrolek_drake.workcell.grasp import with_jaw
from hydrolek_drake.workcell.pipe import workcell_entries
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Carried:
    """What the plant did, one row for each control sample from where both hold; n rows.

    Attributes:
        time: From the beginning of the way, in s, shape (n,).
        set_point: Of the joints, in rad, shape (n, 14).
        position: Of the joints, true, in rad, shape (n, 14).
        chain_error: Distance in m and angle in rad by which the hands are off their hold, shape (n, 2).
        wanted_error: Likewise of the set points: of the interpolation alone, shape (n, 2).
        internal_force: What the left hand does to the pipe and the right one undoes, besides half its weight each: in
            N, world frame, shape (n, 3).
        moment: Likewise, about the pipe's middle in N m, shape (n, 3).
        friction_used: Larger share of the grips' friction, shape (n,); beyond 1 a hand would slip, which the
            springs do not.
        grip: Forces on both moving fingers in N, shape (n, 2).
        pipe_place: Middle in m and axis of the pipe, shape (n, 6).
        axis_off: Angle in rad between the pipe's axis and where it should be, shape (n,).
        off: Distance in m of the pipe's middle from where it should be, shape (n,).
    """

    time: Array
    set_point: Array
    position: Array
    chain_error: Array
    wanted_error: Array
    internal_force: Array
    moment: Array
    friction_used: Array
    grip: Array
    pipe_place: Array
    axis_off: Array
    off: Array

    def squeeze(self) -> Array:
        """Part of the internal force along the pipe in N, positive where the hands press it together, shape (n,)."""
        along = np.einsum("ij,ij->i", self.internal_force, self.pipe_place[:, 3:])
        return np.asarray(-np.sign(self.pipe_place[:, 4]) * along)  # the left hand presses towards the right

    def csv(self) -> str:
        """One row a control sample, with units in the names of the columns."""
        columns = {
            "time_s": self.time,
            "hands_off_mm": 1e3 * self.chain_error[:, 0],
            "hands_off_deg": np.degrees(self.chain_error[:, 1]),
            "internal_force_x_N": self.internal_force[:, 0],
            "internal_force_y_N": self.internal_force[:, 1],
            "internal_force_z_N": self.internal_force[:, 2],
            "squeeze_N": self.squeeze(),
            "internal_moment_x_Nm": self.moment[:, 0],
            "internal_moment_y_Nm": self.moment[:, 1],
            "internal_moment_z_Nm": self.moment[:, 2],
            "friction_used": self.friction_used,
            "pipe_x_m": self.pipe_place[:, 0],
            "pipe_y_m": self.pipe_place[:, 1],
            "pipe_z_m": self.pipe_place[:, 2],
            "pipe_off_mm": 1e3 * self.off,
        }
        for index, joint in enumerate(JOINTS):
            columns[f"{joint}_set_point_deg"] = np.degrees(self.set_point[:, index])
            columns[f"{joint}_deg"] = np.degrees(self.position[:, index])
        rows = np.column_stack(list(columns.values()))
        return "\n".join(
            [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows), ""]
        )


def simulate_carry(
    plan: CarryPlan,
    *,
    controller: str = "feedforward",
    seed: int = 1,
    settings: dict[str, JointSetting] | None = None,
    tell: Callable[[str], None] = lambda text: None,
) -> Carried:
    """Close both grippers on the pipe, then move it along its way; the hydraulic plant with noisy sensors.

    It begins where the open grippers are around the pipe, which lies on a rest between them. When both hold, the
    pipe's path is solved anew for where the hands then hold it by the measured joints (closing draws each arm by some
    millimetres), so that the set points keep that hold constant.

    Args:
        plan: What is to be done.
        controller: Of the plant, a name of the catalogue.
        seed: Of the sensors' noise.
        settings: See `HydraulicArms`.
        tell: Told what is simulated.

    Raises:
        InputError: A gripper does not hold the pipe, or loses it on the way; the way cannot be had from there.
    """
    values, times, pipe = workcell_entries()["grasp"], carry_entries("times"), plan.pipe
    under = np.array([*pipe.point[:2], pipe.lowest()])
    rest = Table(under, np.array(carry_entries("rest")["size"]), workcell_entries()["table"]["thickness"])
    opened = plan.grasp
    for side in SIDES:
        opened = with_jaw(opened, side, math.radians(values["open_deg"]))
    tell("starting the hydraulic plant")
    arms = HydraulicArms(opened, controller=controller, seed=seed, pipe=pipe, table=rest, settings=settings)
    wanted = opened
    for side in SIDES:
        tell(f"closing the {side} gripper")
        wanted = with_jaw(wanted, side, math.radians(values["closed_deg"]))
        for _ in range(round(times["close"] / sample_s())):
            measured = arms.advance(wanted)
        if arms.holders() < 1 + SIDES.index(side):
            raise InputError(
                f"the {side} gripper does not hold the pipe {times['close']:g} s after it was to close"
            )
    # where the hands hold it now, by what the controllers know
    start = pose_of(pipe.at(arms.pipe_place()))
    path = plan.move.path(start)
    jaws = [7 * (index + 1) - 1 for index in range(len(SIDES))]
    begin = np.array(measured)
    begin[jaws] = wanted[jaws]
    trajectory = plan.trajectory(follow(path, hold_at(measured, start), begin))
    planned, true_hold = hold_at(begin, start), hold_at(arms.position(), start)
    rows: list[tuple[Array, ...]] = []
    duration = trajectory.end_time() + times["settle"]
    count = math.ceil(duration / sample_s())
    for index in range(count):
        now = (index + 1) * sample_s()
        set_point = trajectory.value(min(now, trajectory.end_time()))[:, 0]
        arms.advance(set_point)
        if arms.holders() < len(SIDES):
            raise InputError(f"a gripper lost the pipe {now:.2f} s after the way began")
        rows.append((set_point, arms.position(), arms.internal_force(), arms.grip(), arms.pipe_place()))
        if index % 20 == 0:
            tell(f"{now:.1f} of {duration:.1f} s of the way")
    set_points, positions, internal, grips, places = (np.array(column) for column in zip(*rows, strict=True))
    time = sample_s() * np.arange(1, count + 1)
    should = tools_at(set_points)[0] @ np.linalg.inv(
        planned.right
    )  # the pipe on hands that are at their set points
    return Carried(
        time,
        set_points,
        positions,
        np.column_stack(chain_error(positions, true_hold)),
        np.column_stack(chain_error(set_points, planned)),
        internal[:, :3],
        internal[:, 3:6],
        internal[:, 6],
        grips,
        places,
        np.arccos(np.clip(np.einsum("ij,ij->i", places[:, 3:], should[:, :3, 2]), -1.0, 1.0)),
        np.linalg.norm(places[:, :3] - should[:, :3, 3], axis=1),
    )
