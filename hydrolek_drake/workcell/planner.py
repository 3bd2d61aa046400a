"""Collision-free path from one posture to another: RRT-Connect in joint space, shortened afterwards.

Kuffner and LaValle, RRT-Connect: An efficient approach to single-query path planning, ICRA 2000.
"""

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.pipe import workcell_entries

Array = NDArray[np.float64]

_JOINTS = 7  # of one arm


def plan_path(
    world: CollisionWorld, start: ArrayLike, goal: ArrayLike, generator: np.random.Generator
) -> Array:
    """Postures from `start` to `goal` between which straight ways in joint space touch nothing.

    An arm that stands in both postures alike is not moved, nor are joints 6 and 7 where they stand alike.

    Args:
        world: Says what touches.
        start: Joints `right_j1` ... `left_j7` in rad, shape (14,).
        goal: Likewise.
        generator: For the samples.

    Returns:
        Postures, shape (n, 14), `start` first and `goal` last.

    Raises:
        InputError: Start or goal touches something or is outside the joint limits, or no path was found.
    """
    first, last = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    lower, upper = _limits()
    for name, posture in (("start", first), ("goal", last)):
        outside = np.flatnonzero((posture < lower - 1e-6) | (posture > upper + 1e-6))
        if len(outside):
            side, number = SIDES[outside[0] // _JOINTS], outside[0] % _JOINTS + 1
            raise InputError(f"the {name} of the path has joint {number} of the {side} arm beyond its limit")
        if not world.free(posture):
            pairs = world.what_touches(posture)
            raise InputError(f"the {name} of the path is nearer than {1e3 * world.padding:.0f} mm: {pairs}")
    if world.free_between(first, last):
        return np.stack([first, last])
    path = _connect(world, first, last, generator)
    return _shortened(world, path, generator)


def _limits() -> tuple[Array, Array]:
    limits = [joint_limits(side) for side in SIDES]
    return np.concatenate([one[0] for one in limits]), np.concatenate([one[1] for one in limits])


class _Tree:
    def __init__(self, root: Array) -> None:
        self.nodes, self.parents = [root], [-1]

    def nearest(self, target: Array) -> int:
        return int(np.sum((np.array(self.nodes) - target) ** 2, axis=1).argmin())

    def add(self, node: Array, parent: int) -> int:
        self.nodes.append(node)
        self.parents.append(parent)
        return len(self.nodes) - 1

    def to_root(self, index: int) -> list[Array]:
        path = []
        while index >= 0:
            path.append(self.nodes[index])
            index = self.parents[index]
        return path


def _connect(world: CollisionWorld, first: Array, last: Array, generator: np.random.Generator) -> Array:
    values = workcell_entries()["motion"]
    lower, upper = _limits()
    moving = np.abs(first - last) > 1e-9
    for arm in (slice(0, 5), slice(_JOINTS, _JOINTS + 5)):
        moving[arm] = moving[arm].any()
    low = np.where(np.isfinite(lower), lower, np.minimum(first, last) - np.pi / 2)
    high = np.where(np.isfinite(upper), upper, np.maximum(first, last) + np.pi / 2)
    here, there = _Tree(first), _Tree(last)
    turned = False
    while len(here.nodes) + len(there.nodes) < values["most_nodes"]:
        sample = np.where(moving, generator.uniform(low, high), first)
        reached = _extend(world, here, sample, values["step"], greedy=False)
        if reached is not None:
            met = _extend(world, there, here.nodes[reached], values["step"], greedy=True)
            if met is not None and np.allclose(there.nodes[met], here.nodes[reached], atol=1e-12):
                path = here.to_root(reached)[::-1] + there.to_root(met)[1:]
                return np.array(path[::-1] if turned else path)
        here, there, turned = there, here, not turned
    raise InputError(
        f"no way found from start to goal within {int(values['most_nodes'])} postures; move the machine or "
        "start from another posture"
    )


def _extend(world: CollisionWorld, tree: _Tree, target: Array, step: float, *, greedy: bool) -> int | None:
    """Grow the tree towards `target` by one step, or as far as it goes; the last node, None if blocked at once."""
    index, last = tree.nearest(target), None
    while True:
        node = tree.nodes[index]
        distance = float(np.linalg.norm(target - node))
        if distance < 1e-12:
            return index
        new = target if distance <= step else node + step / distance * (target - node)
        if not world.free_between(node, new):
            return last
        index = last = tree.add(new, index)
        if not greedy or distance <= step:
            return last


def _shortened(world: CollisionWorld, path: Array, generator: np.random.Generator) -> Array:
    """Replace detours by straight ways wherever nothing is touched on them."""
    corners = list(path)
    for _ in range(int(workcell_entries()["motion"]["shortcuts"])):
        if len(corners) < 3:
            break
        i, j = sorted(generator.choice(len(corners), 2, replace=False))
        if j - i >= 2:
            if world.free_between(corners[i], corners[j]):
                corners[i + 1 : j] = []
            continue
        # between points amid two neighbouring stretches
        if i > 0:
            a = corners[i - 1] + generator.random() * (corners[i] - corners[i - 1])
            b = corners[i] + generator.random() * (corners[j] - corners[i])
            if world.free_between(a, b):
                corners[i : i + 1] = [a, b]
    return np.array(corners)


def path_is_free(world: CollisionWorld, path: Sequence[Array]) -> bool:
    """Whether nothing touches all along a path of postures."""
    return all(world.free_between(a, b) for a, b in itertools.pairwise(path))
