"""The grid of places that a search looks at: each has the pipe before the arms, in the camera's sight."""

import math
from collections.abc import Iterator

import numpy as np

from hydrolek_drake.standing.base import Base, Placement
from hydrolek_drake.standing.site import Site
from hydrolek_drake.teleop.plan import camera_in_world
from hydrolek_drake.vision.camera import thesis_camera
from hydrolek_drake.vision.configuration import kinect_entries


def places_before(site: Site, base: Base) -> Iterator[Placement]:
    """Places before which grasp and cut lie as far forward and sideways as an arm may reach.

    Args:
        site: Pipe, grasp and cut.
        base: Ranges of tracks and boom, and the grid's steps.
    """
    step = base.search["distance_step"]
    middle = 0.5 * (site.grasp_point() + site.cut_point())
    camera, sizes = camera_in_world(), kinect_entries("camera")
    farthest = kinect_entries("edges")["farthest"]
    aside = 0.5 * thesis_camera().width / thesis_camera().focal_x
    forward = np.arange(math.ceil(sizes["nearest"] / step), math.floor(farthest / step) + 1) * step
    for boom in _steps(*base.boom, base.search["boom_step"]):
        for heading in _headings(*base.heading, base.search["heading_step"]):
            c, s = math.cos(heading), math.sin(heading)
            for ahead in forward:
                most = math.floor(aside * ahead / step)
                for sideways in np.arange(-most, most + 1) * step:
                    u = camera[0] + ahead + Placement(0.0, 0.0, 0.0, boom).plate_shift()[0]
                    x, y = middle[0] - c * u + s * sideways, middle[1] - s * u - c * sideways
                    placement = Placement(float(x), float(y), heading, boom)
                    if base.allows(placement):
                        yield placement


def _steps(low: float, high: float, step: float) -> list[float]:
    """From end to end, even, no farther apart than a step."""
    if high <= low:
        return [low]
    return [float(each) for each in np.linspace(low, high, max(2, math.ceil((high - low) / step - 1e-9) + 1))]


def _headings(low: float, high: float, step: float) -> list[float]:
    """Multiples of the step within a range, which may hold none: then its middle."""
    if high - low >= math.tau - 1e-9:
        count = max(1, round(math.tau / step))
        return [math.tau * (index - (count - 1) // 2) / count for index in range(count)]
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [index * step for index in range(first, last + 1)] or [0.5 * (low + high)]
