"""A loose pipe on the table, and where its places lie in the camera's picture."""

import numpy as np

from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.vision.camera import camera_pose, thesis_camera
from hydrolek_drake.workcell.table import make_loose_pipe, make_table

TABLE = make_table()
PIPE = make_loose_pipe(TABLE)
RAISED, GRASP = (PIPE.point + np.array([0, 0, up]) for up in (0.1, 0.2))
PLACE = np.array([1.85, 0.20, TABLE.top[2]])


def pixel(point):
    """Pixel of a point in the world [m]."""
    pose = camera_pose()
    on_plate = in_frame(point, given_in="world", wanted_in="plate")
    return thesis_camera().pixel((on_plate - pose[:3, 3]) @ pose[:3, :3])
