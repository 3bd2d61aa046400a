"""Closed form of one arm for a point alone, up to two unknowns: joints 4 and 5.

With both given, the thesis's chain (Tables 5.1 and 5.2) beyond joint 3 is a rigid link w, joint 1 follows from
the sideways distance, s1 p_x + c1 p_z = w_z (two branches), and joints 2 and 3 are a planar pair of links (two
branches). Joints 4 and 5 are free: they are searched for the posture within the limits that is nearest to a
wanted one, first on a grid, then by a pattern search from the grid's best.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.kinematics.compiled_forward import direction_of, wrapped

_OUTSIDE = 1e6  # added to the cost of a posture outside its limits, beyond all distances of postures
_ROUNDING = 1e-12  # of a sine or cosine of 1
_COARSE = (7, 6)  # grid over joints 4 and 5 at first
_FINE = (61, 41)  # and where the coarse one finds nothing
_STARTS = 6  # of the pattern search where even the fine grid has no posture within the limits
_MOST_STEPS = 1000  # of the pattern search; some 20 to 60 as a rule
_SMALLEST_STEP = 5e-3  # rad, of the pattern search for the nearest posture
_SMALLEST_STEP_OUTSIDE = 1e-12  # rad, of the search for the limits' inside


@njit(cache=True)
def position_posture(q4: float, q5: float, branch: int, p: Any, links: Any, q: Any) -> float:
    """Joints 1 to 5 that put the point at `p` with joints 4 and 5 given.

    Args:
        q4: Joint 4 in rad.
        q5: Joint 5 in rad.
        branch: Bit 0: joint 1 with the arm's plane before or behind its axis; bit 1: elbow up or down.
        p: Target from the axis of joint 1, in m, shape (3,).
        links: See `Chain.links`.
        q: Receives joints 1 to 5 in rad.

    Returns:
        0 if the point is reached, else by how much the sines and cosines asked for exceed 1.
    """
    c4, s4, c5, s5 = math.cos(q4), math.sin(q4), math.cos(q5), math.sin(q5)
    g = links[3, 0] + links[4, 0] * c5 - links[4, 1] * s5
    w_x = links[2, 0] + c4 * g
    w_y = links[2, 1] + links[3, 1] + links[4, 0] * s5 + links[4, 1] * c5
    w_z = -s4 * g
    amiss = 0.0
    across = math.hypot(p[0], p[2])
    sine = w_z / across if across > 1e-12 else (2.0 if w_z > 0.0 else -2.0)
    if abs(sine) > 1.0:
        amiss += max(0.0, abs(sine) - 1.0 - _ROUNDING)
        sine = 1.0 if sine > 0.0 else -1.0
    turned = math.asin(sine)
    q1 = (math.pi - turned if branch & 1 else turned) - math.atan2(p[2], p[0])
    r_x = math.cos(q1) * p[0] - math.sin(q1) * p[2] - links[0, 0]
    r_y = p[1] - links[0, 1]
    upper, fore = math.hypot(links[1, 0], links[1, 1]), math.hypot(w_x, w_y)
    reach2 = r_x * r_x + r_y * r_y
    divisor = 2.0 * upper * fore
    cosine = (reach2 - upper * upper - fore * fore) / divisor if divisor > 1e-12 else 2.0
    if abs(cosine) > 1.0:
        amiss += max(0.0, abs(cosine) - 1.0 - _ROUNDING)
        cosine = 1.0 if cosine > 0.0 else -1.0
    bend = math.acos(cosine)
    if branch & 2:
        bend = -bend
    q2 = math.atan2(r_y, r_x) - math.atan2(fore * math.sin(bend), upper + fore * math.cos(bend))
    q2 -= math.atan2(links[1, 1], links[1, 0])
    q3 = bend - math.atan2(w_y, w_x) + math.atan2(links[1, 1], links[1, 0])
    q[0], q[1], q[2], q[3], q[4] = wrapped(q1), wrapped(q2), wrapped(q3), q4, q5
    return amiss


@njit(cache=True)
def _cost(
    q4: float,
    q5: float,
    branch: int,
    p: Any,
    links: Any,
    limits: Any,
    tolerance: float,
    near: Any,
    aim: Any,
    q: Any,
) -> float:
    """Squared distance from `near`, or of the direction from `aim`; beyond `_OUTSIDE`, how impossible it is."""
    amiss = position_posture(q4, q5, branch, p, links, q)
    outside, distance, pointed = amiss, 0.0, q[5:]
    for joint in range(5):
        lower, upper = limits[0, joint] - tolerance, limits[1, joint] + tolerance
        outside += max(0.0, lower - q[joint]) + max(0.0, q[joint] - upper)
        distance += (q[joint] - near[joint]) ** 2
    if outside > 0.0:
        return _OUTSIDE * (1.0 + outside)
    if aim[0] == 0.0 and aim[1] == 0.0 and aim[2] == 0.0:
        return distance
    direction_of(q, pointed)
    return (pointed[0] - aim[0]) ** 2 + (pointed[1] - aim[1]) ** 2 + (pointed[2] - aim[2]) ** 2


@njit(cache=True)
def _improve(
    q4: float,
    q5: float,
    branch: int,
    cost: float,
    step: float,
    p: Any,
    links: Any,
    limits: Any,
    tolerance: float,
    near: Any,
    aim: Any,
    q: Any,
) -> tuple[float, float, float]:
    """Pattern search over joints 4 and 5 from a start; returns both and the cost."""
    for _ in range(_MOST_STEPS):  # along a ridge, ever smaller improvements would never end
        if step <= (_SMALLEST_STEP if cost < _OUTSIDE else _SMALLEST_STEP_OUTSIDE):
            break
        improved = False
        for way in range(8):
            angle = way * math.pi / 4.0
            t4 = min(max(q4 + step * math.cos(angle), limits[0, 3]), limits[1, 3])
            t5 = min(max(q5 + step * math.sin(angle), limits[0, 4]), limits[1, 4])
            trial = _cost(t4, t5, branch, p, links, limits, tolerance, near, aim, q)
            if trial < cost:
                q4, q5, cost, improved = t4, t5, trial, True
                break
        if not improved:
            step *= 0.5
    return q4, q5, cost


@njit(cache=True)
def _grid(
    rows: int,
    columns: int,
    p: Any,
    links: Any,
    limits: Any,
    tolerance: float,
    near: Any,
    aim: Any,
    q: Any,
    best: Any,
) -> None:
    """The best points of a grid, one a row of `best`: cost, joint 4, joint 5, branch; best first."""
    best[:, 0] = math.inf
    last = best.shape[0] - 1
    for row in range(rows):
        q4 = limits[0, 3] + (limits[1, 3] - limits[0, 3]) * row / (rows - 1)
        for column in range(columns):
            q5 = limits[0, 4] + (limits[1, 4] - limits[0, 4]) * column / (columns - 1)
            for branch in range(4):
                cost = _cost(q4, q5, branch, p, links, limits, tolerance, near, aim, q)
                if cost >= best[last, 0]:
                    continue
                place = last
                while place > 0 and best[place - 1, 0] > cost:
                    best[place] = best[place - 1]
                    place -= 1
                best[place, 0], best[place, 1], best[place, 2] = cost, q4, q5
                best[place, 3] = branch


@njit(cache=True)
def solve_position(p: Any, links: Any, limits: Any, tolerance: float, near: Any, aim: Any, q: Any) -> float:
    """Joints 1 to 5 within their limits that put the point at `p`, near the posture `near`.

    Args:
        p: Target from the axis of joint 1, in m, shape (3,).
        links: See `Chain.links`.
        limits: Lower and upper limits of joints 1 to 5 in rad, shape (2, 5).
        tolerance: How far in rad a joint may lie beyond its limit before it is set onto it.
        near: Wanted joints 1 to 5 in rad, shape (5,).
        aim: Direction that the tool shall come as near to as it can instead, shape (3,); zeros for none.
        q: Receives joints 1 to 5 in rad; where there is no posture, the least impossible one found. Room
            for three more numbers follows, shape (8,).

    Returns:
        0 if there is a posture, else how far outside the limits (rad, summed) the least impossible one is.
    """
    best = np.empty((_STARTS, 4))
    cost = math.inf
    for attempt in range(2):
        aimless = aim[0] == 0.0 and aim[1] == 0.0 and aim[2] == 0.0
        rows, columns = _COARSE if attempt == 0 and aimless else _FINE
        _grid(rows, columns, p, links, limits, tolerance, near, aim, q, best)
        step = max((limits[1, 3] - limits[0, 3]) / (rows - 1), (limits[1, 4] - limits[0, 4]) / (columns - 1))
        for start in range(1 if best[0, 0] < _OUTSIDE else _STARTS):
            t4, t5, trial = _improve(
                best[start, 1],
                best[start, 2],
                int(best[start, 3]),
                best[start, 0],
                0.5 * step,
                p,
                links,
                limits,
                tolerance,
                near,
                aim,
                q,
            )
            if trial < cost:
                cost, q4, q5, branch = trial, t4, t5, int(best[start, 3])
        if cost < _OUTSIDE:
            break
    position_posture(q4, q5, branch, p, links, q)
    if cost < _OUTSIDE:
        for joint in range(5):
            q[joint] = min(max(q[joint], limits[0, joint]), limits[1, joint])
    return 0.0 if cost < _OUTSIDE else cost / _OUTSIDE - 1.0
