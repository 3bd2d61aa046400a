"""How well both arms carried a pipe: figures, and a picture over time."""

import io
import math
from typing import Any

import numpy as np

from hydrolek_drake.carrying.plan import CarryPlan, carry_entries
from hydrolek_drake.carrying.simulation import Carried
from hydrolek_drake.kinematics.chain import SIDES, arm_chain
from hydrolek_drake.workcell.closed_chain import chain_error
from hydrolek_drake.workcell.trajectory import joint_speeds

_SAMPLES = 400
_COLOURS = ("#1f5fa8", "#c0392b", "#3a8f4d", "#8a5fa8")


def plan_figures(plan: CarryPlan) -> dict[str, float]:
    """Of the planned way: chain error of the interpolated set points, margin to the stops, speed."""
    trajectory = plan.trajectory()
    times = np.linspace(0.0, trajectory.end_time(), _SAMPLES)
    postures = np.array([trajectory.value(time)[:, 0] for time in times])
    rates = np.array([trajectory.EvalDerivative(time, 1)[:, 0] for time in times])
    error, turn = chain_error(postures, plan.hold)
    margin = min(
        float(np.min(np.minimum(angles - arm_chain(side).lower[:5], arm_chain(side).upper[:5] - angles)))
        for index, side in enumerate(SIDES)
        for angles in (postures[:, 7 * index : 7 * index + 5],)
    )
    return {
        "duration_s": float(trajectory.end_time()),
        "chain_error_mm": 1e3 * float(error.max()),
        "chain_error_deg": math.degrees(float(turn.max())),
        "joint_margin_deg": math.degrees(margin),
        "speed_used": float(np.max(np.abs(rates) / joint_speeds()[0])),
    }


def carried_figures(carried: Carried) -> dict[str, float]:
    """Of the full plant: largest values on the way and after it, and root mean squares."""
    force = np.linalg.norm(carried.internal_force, axis=1)
    moment = np.linalg.norm(carried.moment, axis=1)
    return {
        "chain_error_mm": 1e3 * float(carried.chain_error[:, 0].max()),
        "chain_error_deg": math.degrees(float(carried.chain_error[:, 1].max())),
        "chain_error_rms_mm": 1e3 * float(np.sqrt(np.mean(carried.chain_error[:, 0] ** 2))),
        "internal_force_N": float(force.max()),
        "internal_force_rms_N": float(np.sqrt(np.mean(force**2))),
        "internal_force_at_the_end_N": float(force[-1]),
        "squeeze_N": float(carried.squeeze()[np.argmax(np.abs(carried.squeeze()))]),
        "moment_Nm": float(moment.max()),
        "friction_used": float(carried.friction_used.max()),
        "least_grip_N": float(carried.grip.min()),
        "pipe_off_mm": 1e3 * float(carried.off.max()),
        "pipe_off_at_the_end_mm": 1e3 * float(carried.off[-1]),
        "axis_off_deg": math.degrees(float(carried.axis_off.max())),
        "tolerance_mm": 1e3 * carry_entries("tolerance")["chain_error"],
    }


def carried_png(plan: CarryPlan, carried: Carried) -> bytes:
    """Over time: how far the chain is from closed, the internal force, and the pipe off its way."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, 8.6), layout="constrained")
    axes: Any = figure.subplots(4, 1, sharex=True)
    time, end = carried.time, plan.trajectory().end_time()
    axes[0].plot(time, 1e3 * carried.chain_error[:, 0], color=_COLOURS[0], label="plant")
    axes[0].plot(time, 1e3 * carried.wanted_error[:, 0], color=_COLOURS[2], label="set points")
    axes[0].axhline(
        1e3 * carry_entries("tolerance")["chain_error"], color="black", linestyle="--", label="tolerance"
    )
    axes[0].set_ylabel("hands off\ntheir hold [mm]")
    axes[1].plot(
        time, np.linalg.norm(carried.internal_force, axis=1), color=_COLOURS[0], label="internal force"
    )
    axes[1].plot(time, carried.squeeze(), color=_COLOURS[1], label="along the pipe, squeezing positive")
    axes[1].set_ylabel("force [N]")
    axes[2].plot(
        time, np.linalg.norm(carried.moment, axis=1), color=_COLOURS[0], label="internal moment [N m]"
    )
    axes[2].plot(time, 100.0 * carried.friction_used, color=_COLOURS[3], label="friction used [%]")
    axes[2].set_ylabel("moment, friction")
    axes[3].plot(time, 1e3 * carried.off, color=_COLOURS[0], label="pipe's middle off its way [mm]")
    axes[3].plot(time, np.degrees(carried.axis_off), color=_COLOURS[1], label="pipe's axis off [deg]")
    axes[3].set(ylabel="pipe", xlabel="time since the way began [s]")
    for axis in axes:
        axis.axvline(end, color="#999999", linewidth=0.8)
        axis.grid(alpha=0.3)
        axis.legend(loc="upper right", fontsize=8, ncols=3)
        low, high = axis.get_ylim()
        axis.set_ylim(low, high + 0.25 * (high - low))
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()
