"""Closed form of one arm for a point and a tool direction, up to one unknown: joint 5.

A target is one root of one function of joint 5 for each branch (`direction_posture`); it is bracketed on a grid and
polished.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.kinematics.compiled_forward import direction_of, point_of, wrapped
from hydrolek_drake.kinematics.direction_posture import posture

_SAMPLES_PER_RADIAN = 30  # of the grid over joint 5
_POLISH_STEPS = 60  # at most, of the bracketing search
_TOUCHING = 1e-7  # m: a root at which the length touches without crossing (a singular posture)
_CLOSE = 1e-5  # rad: two roots that are one
_ON_TARGET = 1e-6  # m: what a solution may miss at most; polished ones miss some 1e-12
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@njit(cache=True)
def _accept(
    q5: float,
    branch: int,
    p: Any,
    d: Any,
    links: Any,
    limits: Any,
    tolerance: float,
    q: Any,
    found: Any,
    count: int,
) -> int:
    """Store the posture at a root if it is within the limits, on target and new; returns the count."""
    posture(q5, branch, p, d, links, q)
    for joint in range(5):
        if q[joint] < limits[0, joint] - tolerance or q[joint] > limits[1, joint] + tolerance:
            turned = q[joint] + (2.0 * math.pi if q[joint] < 0.0 else -2.0 * math.pi)
            if turned < limits[0, joint] - tolerance or turned > limits[1, joint] + tolerance:
                return count
            q[joint] = turned
        q[joint] = min(max(q[joint], limits[0, joint]), limits[1, joint])
    reached, pointed = np.empty(3), np.empty(3)
    point_of(q, links, reached)
    direction_of(q, pointed)
    off, turned_off = 0.0, 0.0
    for axis in range(3):
        off += (reached[axis] - p[axis]) ** 2
        turned_off += (pointed[axis] - d[axis]) ** 2
    slack = _ON_TARGET + tolerance * 10.0
    if off > slack * slack or turned_off > slack * slack:
        return count
    for known in range(count):
        distance = 0.0
        for joint in range(5):
            distance += abs(found[known, joint] - q[joint])
        if distance < _CLOSE:
            return count
    if count < found.shape[0]:
        for joint in range(5):
            found[count, joint] = q[joint]
        count += 1
    return count


@njit(cache=True)
def _root(
    a: float, f_a: float, b: float, f_b: float, branch: int, p: Any, d: Any, links: Any, q: Any
) -> float:
    """Root between `a` and `b`, where the length amiss has opposite signs (Anderson-Björck)."""
    for _ in range(_POLISH_STEPS):
        x = b - f_b * (b - a) / (f_b - f_a)
        if not (min(a, b) < x < max(a, b)):
            x = 0.5 * (a + b)
        f_x, _room = posture(x, branch, p, d, links, q)
        if abs(f_x) < 1e-13 or abs(b - a) < 1e-15:
            return x
        if (f_x > 0.0) != (f_b > 0.0):
            a, f_a = b, f_b
        else:
            shrink = 1.0 - f_x / f_b
            f_a *= shrink if shrink > 0.0 else 0.5
        b, f_b = x, f_x
    return b


@njit(cache=True)
def _edge(inside: float, outside: float, branch: int, p: Any, d: Any, links: Any, q: Any) -> float:
    """Where, between an angle that can have the direction and one that cannot, the last is that can."""
    for _ in range(50):
        middle = 0.5 * (inside + outside)
        _amiss, room = posture(middle, branch, p, d, links, q)
        if room >= 0.0:
            inside = middle
        else:
            outside = middle
    return inside


@njit(cache=True)
def _lowest(
    a: float, b: float, sign: float, of_room: bool, branch: int, p: Any, d: Any, links: Any, q: Any
) -> float:
    """Golden section: where `sign` times the length amiss (or the room) is lowest between a and b."""
    x1, x2 = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    amiss1, room1 = posture(x1, branch, p, d, links, q)
    amiss2, room2 = posture(x2, branch, p, d, links, q)
    f1, f2 = (sign * room1, sign * room2) if of_room else (sign * amiss1, sign * amiss2)
    for _ in range(45):
        if f1 < f2:
            b, x2, f2 = x2, x1, f1
            x1 = b - _GOLDEN * (b - a)
            amiss1, room1 = posture(x1, branch, p, d, links, q)
            f1 = sign * room1 if of_room else sign * amiss1
        else:
            a, x1, f1 = x1, x2, f2
            x2 = a + _GOLDEN * (b - a)
            amiss2, room2 = posture(x2, branch, p, d, links, q)
            f2 = sign * room2 if of_room else sign * amiss2
    return 0.5 * (a + b)


@njit(cache=True)
def _piece(
    start: float,
    end: float,
    samples: int,
    branch: int,
    p: Any,
    d: Any,
    links: Any,
    limits: Any,
    tolerance: float,
    found: Any,
    count: int,
) -> int:
    """All roots between `start` and `end`, where the direction can be had throughout."""
    q = np.empty(5)
    angles, amiss = np.empty(samples + 1), np.empty(samples + 1)
    for index in range(samples + 1):
        # dense at both ends, where the length may change as the root of the distance from an edge
        share = 0.5 - 0.5 * math.cos(math.pi * index / samples)
        angles[index] = start + (end - start) * share
        amiss[index], _room = posture(angles[index], branch, p, d, links, q)
    for index in range(samples + 1):
        f = amiss[index]
        if abs(f) < _TOUCHING:
            count = _accept(angles[index], branch, p, d, links, limits, tolerance, q, found, count)
        if index == samples:
            break
        g = amiss[index + 1]
        if f * g < 0.0:
            root = _root(angles[index], f, angles[index + 1], g, branch, p, d, links, q)
            count = _accept(root, branch, p, d, links, limits, tolerance, q, found, count)
        elif index > 0 and abs(f) <= abs(g) and abs(f) < abs(amiss[index - 1]) and f * amiss[index - 1] > 0.0:
            # the length comes near without crossing on the grid: two roots between two samples, or one
            sign = 1.0 if f > 0.0 else -1.0
            low = _lowest(angles[index - 1], angles[index + 1], sign, False, branch, p, d, links, q)
            f_low, _room = posture(low, branch, p, d, links, q)
            if f_low * f < 0.0:
                for other in (index - 1, index + 1):
                    root = _root(low, f_low, angles[other], amiss[other], branch, p, d, links, q)
                    count = _accept(root, branch, p, d, links, limits, tolerance, q, found, count)
            elif abs(f_low) < _TOUCHING:
                count = _accept(low, branch, p, d, links, limits, tolerance, q, found, count)
    return count


@njit(cache=True)
def solve_direction(p: Any, d: Any, links: Any, limits: Any, tolerance: float, found: Any) -> int:
    """All postures of joints 1 to 5 that put the point at `p` with the tool along `d`.

    Args:
        p: Target from the axis of joint 1, in m, shape (3,).
        d: Direction of the tool, unit vector, shape (3,).
        links: See `Chain.links`.
        limits: Lower and upper limits of joints 1 to 5 in rad, shape (2, 5).
        tolerance: How far in rad a joint may lie beyond its limit before it is set onto it.
        found: Receives the postures, one a row, shape (n, 5).

    Returns:
        Number of postures.
    """
    q = np.empty(5)
    first, last = limits[0, 4] - tolerance, limits[1, 4] + tolerance
    intervals = math.ceil((last - first) * _SAMPLES_PER_RADIAN) + 1
    step = (last - first) / intervals
    rooms = np.empty(intervals + 1)
    count = 0
    for forwards in range(2):
        # room and joint 1 are the same for both branches of joint 4
        nearest, jump, before = math.inf, 0.0, 0.0
        for index in range(intervals + 1):
            _amiss, rooms[index] = posture(first + index * step, forwards, p, d, links, q)
            if limits[0, 0] <= q[0] <= limits[1, 0]:
                nearest = 0.0
            for end in range(2):
                nearest = min(nearest, abs(wrapped(q[0] - limits[end, 0])))
            if index > 0:
                jump = max(jump, abs(wrapped(q[0] - before)))
            before = q[0]
        if nearest > jump + tolerance:
            continue  # joint 1 stays outside its limits all along
        index = 0
        while index <= intervals:
            if rooms[index] < 0.0:
                # a short piece may lie between two samples
                if (
                    0 < index < intervals
                    and rooms[index] > rooms[index - 1]
                    and rooms[index] >= rooms[index + 1]
                ):
                    here = first + index * step
                    best = _lowest(here - step, here + step, -1.0, True, forwards, p, d, links, q)
                    _amiss, room = posture(best, forwards, p, d, links, q)
                    if room >= 0.0:
                        start = _edge(best, here - step, forwards, p, d, links, q)
                        end = _edge(best, here + step, forwards, p, d, links, q)
                        for back in range(2):
                            count = _piece(
                                start,
                                end,
                                8,
                                forwards + 2 * back,
                                p,
                                d,
                                links,
                                limits,
                                tolerance,
                                found,
                                count,
                            )
                index += 1
                continue
            until = index
            while until < intervals and rooms[until + 1] >= 0.0:
                until += 1
            start, end = first + index * step, first + until * step
            if index > 0:
                start = _edge(start, start - step, forwards, p, d, links, q)
            if until < intervals:
                end = _edge(end, end + step, forwards, p, d, links, q)
            for back in range(2):
                count = _piece(
                    start,
                    end,
                    max(8, 3 * (until - index) // 2),
                    forwards + 2 * back,
                    p,
                    d,
                    links,
                    limits,
                    tolerance,
                    found,
                    count,
                )
            index = until + 1
    return count
