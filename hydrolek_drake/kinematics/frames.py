"""Where the fixed frames of the machine are: arm bases, shoulder plate, world; from the URDF."""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.multibody.plant import MultibodyPlant

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import make_arms_plant

Array = NDArray[np.float64]

FIXED_FRAMES = ("right_base", "left_base", "plate", "world")


@cache
def fixed_pose(frame: str, of: str) -> Array:
    """Pose of frame `of` in frame `frame`, X_frame_of, a homogeneous transform of shape (4, 4), in m.

    Raises:
        InputError: A frame that is unknown or moves.
    """
    plant = _plant()
    for name in (frame, of):
        if name not in FIXED_FRAMES:
            raise InputError(f"frame '{name}' is unknown; choose from {', '.join(FIXED_FRAMES)}")
    context = plant.CreateDefaultContext()
    pose = plant.GetFrameByName(of).CalcPose(context, plant.GetFrameByName(frame)).GetAsMatrix4()
    pose.flags.writeable = False  # shared by all callers through the cache
    return pose


def in_frame(points: ArrayLike, *, given_in: str, wanted_in: str) -> Array:
    """Points (..., 3) of one fixed frame in another one, in m.

    Raises:
        InputError: A frame that is unknown or moves.
    """
    pose = fixed_pose(wanted_in, given_in)
    return np.asarray(points, dtype=float) @ pose[:3, :3].T + pose[:3, 3]


def direction_in_frame(vectors: ArrayLike, *, given_in: str, wanted_in: str) -> Array:
    """Directions (..., 3) of one fixed frame in another one.

    Raises:
        InputError: A frame that is unknown or moves.
    """
    return np.asarray(vectors, dtype=float) @ fixed_pose(wanted_in, given_in)[:3, :3].T


@cache
def _plant() -> MultibodyPlant:
    return make_arms_plant()
