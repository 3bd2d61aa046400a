"""What the other joints of a machine do to one joint while all of them move, from how they moved.

A rollout knows one joint. Others that move at the same time draw oil from the same pump and move the arm that the
joint carries: the load is the inverse dynamics of the whole arm along its motion (Siciliano et al., Robotics, 2009,
section 7.5), less what the joint would carry with the others held. Motion and flow may be those of a simulation of the
whole machine (`diagnosis.together`), or follow from measured angles without any model of the valves: the flow into a
cylinder is its area times the rod's speed. Smoothed angles do not tell how fast an arm shakes on its oil.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.physics import load
from hydrolek_drake.physics.bodies.serial_arm import moments_along
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.one_point import stroke_and_lever
from hydrolek_drake.rollout.together.arms import arm_links, carriers_of, payloads

SPACING_S = 0.01
"""Spacing of the samples of what the others do [s]."""

WINDOW_S = 0.25
"""Measured angles are smoothed and differentiated over so long: a joint's fastest change of speed, while the noise of
an acceleration stays some percent of the accelerations of a move."""

ORDER = 3
"""Of the polynomial that is fitted within the window."""


Motion = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Position, velocity and acceleration of a joint. # (n,) each."""


def motion(time: np.ndarray, angle: np.ndarray, grid: np.ndarray) -> Motion:
    """Smoothed position, velocity and acceleration of a measured angle (Savitzky-Golay).

    Args:
        time: of the samples [s]. # (n,)
        angle: [rad or m]; NaN where there is no value. # (n,)
        grid: uniform times at which they are wanted [s]. # (m,)
    """
    # it takes more than a second to load, and joints mostly move alone
    from scipy.signal import savgol_filter

    known = np.isfinite(angle)
    uniform = np.interp(grid, time[known], angle[known])
    spacing = float(grid[1] - grid[0])
    width = max(2 * round(0.5 * WINDOW_S / spacing) + 1, ORDER + 2)
    width = min(width, 2 * ((grid.size - 1) // 2) + 1)
    position, velocity, acceleration = (
        savgol_filter(uniform, width, ORDER, deriv=order, delta=spacing, mode="interp") for order in range(3)
    )
    return position, velocity, acceleration


def drawn_flow(record: np.void, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Flow that a joint draws from the supply [m^3/s]: area of the fed side times the rod's speed. # (n,)."""
    lever = np.array([stroke_and_lever(q, record)[1] for q in position])
    rod_speed = lever * velocity
    area_a, area_b = float(record["cylinder"]["area_a"]), float(record["cylinder"]["area_b"])
    return np.where(rod_speed > 0.0, area_a * rod_speed, -area_b * rod_speed)


def effects_of_others(
    rig: Rig, measured: Mapping[str, tuple[np.ndarray, np.ndarray]]
) -> dict[str, tuple[float, np.ndarray]]:
    """Probes that make each joint's rollout feel the others.

    Args:
        rig: the machine.
        measured: joint -> times [s] and position [rad or m], of every joint that moves.

    Returns:
        Joint -> spacing [s] and rows of `probes.PROBES`, from the joint's first sample on; empty if fewer than two
        joints move or the joints are driven by motors of their own.
    """
    hydraulic = [j for j in measured if rig.is_hydraulic(j)]
    if len(hydraulic) < 2:
        return {}
    records = dict(zip(rig.joints, rig.records(), strict=True))
    begin = min(float(time[0]) for time, _ in measured.values())
    end = max(float(time[-1]) for time, _ in measured.values())
    grid = begin + SPACING_S * np.arange(int((end - begin) / SPACING_S) + 2)
    motions = {joint: motion(*measured[joint], grid) for joint in hydraulic}
    flows = {joint: drawn_flow(records[joint], *motions[joint][:2]) for joint in hydraulic}
    firsts = {joint: float(measured[joint][0][0]) - begin for joint in hydraulic}
    return probes_of(rig, motions, flows, SPACING_S, firsts)


def probes_of(
    rig: Rig,
    motions: Mapping[str, Motion],
    flows: Mapping[str, np.ndarray],
    spacing: float,
    firsts: Mapping[str, float],
) -> dict[str, tuple[float, np.ndarray]]:
    """Probes that make each joint's rollout feel the others, from how all of them moved.

    Args:
        rig: the machine.
        motions: joint -> how it moved.
        flows: joint -> what it drew from the supply [m^3/s]. # (n,)
        spacing: of the samples [s].
        firsts: joint whose probes are wanted -> when its rollout begins, after the first sample [s].

    Returns:
        Joint -> spacing [s] and rows of `probes.PROBES`, from its beginning on.
    """
    records = dict(zip(rig.joints, rig.records(), strict=True))
    total = np.sum(list(flows.values()), axis=0)
    moments = _loads_of_others(rig, records, motions, spacing * np.arange(total.size))
    found = {}
    for joint, after in firsts.items():
        rows = np.zeros((total.size, len(PROBES)))
        rows[:, PROBES.index("flow")] = total - flows[joint]
        rows[:, PROBES.index("load")] = -moments.get(joint, 0.0)
        found[joint] = (spacing, rows[round(after / spacing) :])
    return found


def _loads_of_others(
    rig: Rig,
    records: Mapping[str, np.void],
    motions: Mapping[str, Motion],
    times: np.ndarray,
) -> dict[str, np.ndarray]:
    """Joint -> moment by which the moving arm resists more than with the other joints held [N m]."""
    arm = [joint for joint in rig.joints if joint in motions and rig.variant(joint, "load") == "arm"]
    if not arm:
        return {}
    position, velocity, acceleration = (
        np.stack([motions[joint][order] for joint in arm], axis=1) for order in range(3)
    )
    hanging = payloads(carriers_of(rig, arm, rig.records()), times)
    needed = moments_along(arm_links(rig, arm), position, velocity, acceleration, hanging)
    more = {}
    for column, joint in enumerate(arm):
        angle, _, accelerated = motions[joint]
        more[joint] = needed[:, column] - _alone(records[joint], times, angle, accelerated)
    return more


@njit(cache=True)
def _alone(joint: Any, times: np.ndarray, position: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Moment that a joint's motion needs with the others held [N m]. # (n,)."""
    needed = np.empty(position.size)
    for n in range(position.size):
        carried = load.gravity_load(position[n], times[n], joint)
        needed[n] = load.moving_inertia(times[n], joint) * acceleration[n] + carried
    return needed


def with_recorded(
    inputs: tuple[float, np.ndarray] | None, recorded: tuple[float, np.ndarray] | None
) -> tuple[float, np.ndarray] | None:
    """Inputs from outside with what was recorded in place of a part of the model, at the finer spacing of the two.

    Inputs of the replaced part act on nothing, and give way.
    """
    if inputs is None or recorded is None:
        return inputs or recorded
    spacing = min(inputs[0], recorded[0])
    last = max(own * (len(rows) - 1) for own, rows in (inputs, recorded))
    count = round(last / spacing) + 1
    rows, driving = rows_at(inputs, spacing, count), rows_at(recorded, spacing, count)
    return spacing, np.where(np.any(recorded[1] != 0.0, axis=0), driving, rows)


def rows_at(probes: tuple[float, np.ndarray], spacing: float, count: int) -> np.ndarray:
    """Rows of probes at another spacing, on straight lines between their samples. # (count, probes)."""
    own_spacing, rows = probes
    own, wanted = own_spacing * np.arange(len(rows)), spacing * np.arange(count)
    return np.stack([np.interp(wanted, own, column) for column in rows.T], axis=1)
