"""From one frame to the pictures that the operator clicks into."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.vision.camera import CameraModel, checked_frame
from hydrolek_drake.vision.edges import EdgeSettings, edge_picture, reach_mask
from hydrolek_drake.vision.selection import Snapshot
from hydrolek_drake.vision.surfaces import find_surfaces

_SEED = 1  # of the samples for planes: the same frame always gives the same snapshot


def take_snapshot(
    colour: NDArray[np.uint8],
    depth: NDArray[np.uint16],
    camera: CameraModel,
    settings: EdgeSettings,
) -> Snapshot:
    """Reach mask, edges and surfaces of a frame (5.2.2).

    Args:
        colour: Blue, green, red, aligned with the depth, shape (h, w, 3).
        depth: In mm along the optical axis, 0 for no reading, shape (h, w).
        camera: The camera that took both.
        settings: The operator's sliders.

    Raises:
        InputError: Pictures that are not the camera's.
    """
    checked_frame(colour, depth, camera)
    mask = reach_mask(depth, settings)
    with ThreadPoolExecutor(1) as beside:  # OpenCV and the compiled parts run outside Python's lock
        edges = beside.submit(edge_picture, colour, mask, settings)
        surfaces = find_surfaces(depth, mask, camera, np.random.default_rng(_SEED))
        return Snapshot(colour, mask, edges.result(), surfaces, settings)
