"""The arms that joints of a machine turn: which joints move with some, their links, and what hangs on their tools."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.bodies.serial_arm import LINK_SIZE
from hydrolek_drake.rigs import Rig

NO_LINKS = np.zeros((0, LINK_SIZE))
"""Of joints that no arm has."""


def moving_with(rig: Rig, joints: Sequence[str]) -> tuple[str, ...]:
    """Joints that move when some are driven: all of their arms, which give way on their oil; else these alone."""
    sides = {joint.split("_")[0] for joint in joints if _of_arm(rig, joint)}
    return tuple(j for j in rig.joints if j in joints or (_of_arm(rig, j) and j.split("_")[0] in sides))


def arm_links(rig: Rig, joints: Sequence[str]) -> np.ndarray:
    """Links that turn about some joints, in their order, with the rest where the rig holds it; none if no arm has them.

    Args:
        rig: the machine.
        joints: that move, each after those that carry it.
    """
    if not _of_arm(rig, joints[0]):
        return NO_LINKS
    starts = {j: rig.value(f"joints.{j}.load.initial_position") for j in rig.joints if _of_arm(rig, j)}
    held = {j: q for j, q in {**starts, **rig.held}.items() if j not in joints}
    return _links_of(tuple(joints), tuple(sorted(held.items())))


def carriers_of(rig: Rig, joints: Sequence[str], records: np.ndarray) -> np.ndarray:
    """Records that say what hangs on the tool of each joint's arm: those of its first joint with a payload.

    An arm has one tool, and all of its joints feel the same payload, as in the Diagram.

    Args:
        rig: the machine.
        joints: of the links.
        records: of all joints of the rig. # (rig's joints,)

    Returns:
        # (joints,)
    """
    loaded = records["effects"]["load_payload"]["mass_kg"] > 0.0
    places = []
    for joint in joints:
        arm = [rig.joints.index(j) for j in rig.joints if j.split("_")[0] == joint.split("_")[0]]
        places.append(next((place for place in arm if loaded[place]), rig.joints.index(joint)))
    return np.ascontiguousarray(records[places])


def payloads(carriers: np.ndarray, times: np.ndarray) -> np.ndarray:
    """What hangs on the tool of each joint's arm [kg]. # (k, joints).

    Args:
        carriers: see `carriers_of`. # (joints,)
        times: since switching on [s]. # (k,)
    """
    hanging = np.empty((len(times), len(carriers)))
    _payloads(carriers, times, hanging)
    return hanging


@njit(cache=True)
def _payloads(carriers: np.ndarray, times: np.ndarray, hanging: np.ndarray) -> None:
    for k in range(len(times)):
        for i in range(len(carriers)):
            hanging[k, i] = hooks.payload(times[k], carriers[i])


def _of_arm(rig: Rig, joint: str) -> bool:
    return rig.variant(joint, "load") == "arm"


@cache
def _links_of(joints: tuple[str, ...], held: tuple[tuple[str, float], ...]) -> np.ndarray:
    # Drake takes a second to load, and joints mostly move alone
    from hydrolek_drake.kinematics.rigid_links import rigid_links

    return rigid_links(joints, dict(held))
