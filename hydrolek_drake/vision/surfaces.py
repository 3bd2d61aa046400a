"""Surfaces from depth: what stands out of walls, floors and tables, and where one object ends and the next begins.

Beyond the thesis, whose colour edges (5.2.2) cut a printed tin into a hundred pieces: an object ends where the
depth jumps, where it meets a large plane, or at a concave crease; markings and poor light do not matter.
"""

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.vision.camera import CameraModel
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.surface_kernel import creases, grow, inliers, least_height, normals

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

_STRIDE = 2  # normals at half resolution
_WINDOW = 5  # pixels of that, across and down
_APART = 3  # pixels of that, to either side of a crease
_SAME_SURFACE = 0.06  # m: larger steps are jumps, not creases
_SAMPLES = 1500  # for planes
_TRIALS = 150  # with 3 samples each: a plane of a quarter of the picture is missed once in ten
_PLANES = 3


@dataclass(frozen=True)
class Surfaces:
    """What the depth picture says about objects, before anything is decided.

    Each strength is a quantity over its threshold in `kinect.yaml`, so that 1 decides at the threshold as it stands,
    and another number at all thresholds that many times as high.

    Attributes:
        depth: In m, 0 for no reading or out of reach, median filtered; shape (h, w).
        height: Strength of standing out of every large plane, shape (h, w).
        jump: Strength of the step of depth to the neighbours, shape (h, w).
        crease: Strength of a concave crease, shape (h, w).
        planes: a, b, c of each large plane, a X + b Y + c Z = 1 in the camera frame; shape (n, 3).
        camera: That took the picture.
    """

    depth: Floats
    height: Floats
    jump: Floats
    crease: Floats
    planes: Array
    camera: CameraModel


@dataclass(frozen=True)
class Pieces:
    """A depth picture cut where it jumps, creases or meets a plane.

    Attributes:
        numbers: Number of the piece of surface that each pixel belongs to, 0 for none; shape (h, w).
        standing_out: Whether a pixel stands out of every large plane; shape (h, w).
    """

    numbers: NDArray[np.int32]
    standing_out: NDArray[np.bool_]


def find_surfaces(
    depth: NDArray[np.uint16],
    mask: NDArray[np.bool_],
    camera: CameraModel,
    generator: np.random.Generator,
) -> Surfaces:
    """Planes of a depth picture, and how strongly it stands out of them, jumps and creases.

    Args:
        depth: In mm, 0 for no reading, shape (h, w).
        mask: What is within reach, shape (h, w).
        camera: The camera that took the picture.
        generator: For the samples that planes are sought with.
    """
    values = kinect_entries("surfaces")
    metres = cv2.medianBlur(depth, 5).astype(np.float32) * np.float32(1e-3)
    metres[~mask] = 0.0
    planes = _find_planes(metres, camera, generator)
    height = np.empty_like(metres)
    least_height(metres, _ray_slopes(camera), planes, height)
    within = metres > 0.0
    # nearer than 0.7 m the sensor's noise falls no further
    height /= np.float32(values["height"]) * np.maximum(metres, np.float32(0.7)) ** 2
    square = np.ones((3, 3), np.uint8)
    far = cv2.dilate(metres, square)
    near = cv2.erode(np.where(within, metres, np.float32(np.inf)), square)
    jump = np.where(within, far - near, np.float32(0.0))
    jump /= np.float32(values["jump"]) * np.maximum(metres, np.float32(0.5))
    crease = _creases(metres, camera) / np.float32(values["crease"])
    return Surfaces(metres, height, jump, crease, planes, camera)


def cut_into_pieces(surfaces: Surfaces, scale: float) -> Pieces:
    """Pieces of surface that an object consists of.

    Args:
        surfaces: Of the frame.
        scale: What all thresholds are multiplied by: below 1 it is cut more finely.
    """
    values = kinect_entries("surfaces")
    square = np.ones((3, 3), np.uint8)
    standing_out = ((surfaces.depth > 0.0) & (surfaces.height > scale)).astype(np.uint8)
    standing_out = cv2.morphologyEx(standing_out, cv2.MORPH_OPEN, square)
    crease = cv2.resize(
        (surfaces.crease > scale).astype(np.uint8),
        standing_out.shape[::-1],
        interpolation=cv2.INTER_NEAREST,
    )
    core = standing_out & ~crease & ~(surfaces.jump > scale).astype(np.uint8) & 1
    core = cv2.morphologyEx(core, cv2.MORPH_OPEN, square)
    _, numbers = cv2.connectedComponents(core, connectivity=4)
    grow(numbers, standing_out, int(values["smallest"]), int(values["reach"]))
    return Pieces(numbers, standing_out.astype(bool))


@cache
def _ray_slopes(camera: CameraModel) -> Floats:
    across = (np.arange(camera.width) - camera.centre_x) / camera.focal_x
    down = (np.arange(camera.height) - camera.centre_y) / camera.focal_y
    return np.concatenate([across, down]).astype(np.float32)


@cache
def _coarse_rays(camera: CameraModel) -> Floats:
    slopes = _ray_slopes(camera)
    grid = np.meshgrid(slopes[: camera.width : _STRIDE], slopes[camera.width :: _STRIDE])
    return np.ascontiguousarray(np.stack(grid))


def _inverse(metres: Floats) -> Floats:
    inverse = np.zeros_like(metres)
    np.divide(1.0, metres, out=inverse, where=metres > 0.0)
    return inverse


def _creases(metres: Floats, camera: CameraModel) -> Floats:
    coarse = _inverse(np.ascontiguousarray(metres[::_STRIDE, ::_STRIDE]))
    valid = (coarse > 0.0).astype(np.float32)
    one = np.ones(_WINDOW, np.float32)
    along = (np.arange(_WINDOW, dtype=np.float32) - _WINDOW // 2) * _STRIDE
    moments = [(valid, one, one), (valid, along, one), (valid, one, along), (valid, along**2, one)]
    moments += [(valid, one, along**2), (valid, along, along)]
    moments += [(coarse, one, one), (coarse, along, one), (coarse, one, along)]
    constant = cv2.BORDER_CONSTANT  # nothing beyond the picture
    sums = np.stack([cv2.sepFilter2D(of, cv2.CV_32F, u, v, borderType=constant) for of, u, v in moments])
    normal, point = np.empty((*coarse.shape, 3), np.float32), np.empty((*coarse.shape, 3), np.float32)
    focal = np.array([camera.focal_x, camera.focal_y])
    normals(sums, 0.6 * _WINDOW**2, _coarse_rays(camera), focal, normal, point)
    crease = np.empty_like(coarse)
    creases(normal, point, _APART, _SAME_SURFACE, crease)
    return crease


def _find_planes(metres: Floats, camera: CameraModel, generator: np.random.Generator) -> Array:
    """Large planes, one after the other, each by random samples and least squares in inverse depth."""
    values = kinect_entries("surfaces")
    coarse = _inverse(np.ascontiguousarray(metres[::4, ::4]))
    slopes = _ray_slopes(camera)
    rays = np.stack(np.meshgrid(slopes[: camera.width : 4], slopes[camera.width :: 4]))
    left = coarse > 0.0
    planes: list[Array] = []
    while len(planes) < _PLANES:
        there = np.flatnonzero(left)
        if len(there) < values["plane_share"] * left.size:
            break
        chosen = generator.choice(there, min(_SAMPLES, len(there)), replace=False)
        sampled = rays.reshape(2, -1)[:, chosen].astype(float)
        inverse = coarse.ravel()[chosen].astype(float)
        plane = _best_plane(sampled, inverse, values["plane_tolerance"], generator)
        if plane is None:
            break
        error = np.abs(plane[0] * rays[0] + plane[1] * rays[1] + plane[2] - coarse)
        on = left & (error < values["plane_tolerance"])
        if on.sum() < values["plane_share"] * left.size or _extent(rays, coarse, on) < values["plane_extent"]:
            break
        planes.append(plane)
        left &= ~cv2.dilate(on.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    return np.array(planes).reshape(-1, 3)


def _best_plane(
    rays: Array, inverse: Array, tolerance: float, generator: np.random.Generator
) -> Array | None:
    equations = np.column_stack([rays[0], rays[1], np.ones(len(inverse))])
    triples = generator.integers(0, len(inverse), (_TRIALS, 3))
    matrices = equations[triples]
    solvable = np.abs(np.linalg.det(matrices)) > 1e-4
    if not solvable.any():
        return None
    candidates = np.linalg.solve(matrices[solvable], inverse[triples][solvable][..., np.newaxis])[..., 0]
    counts = np.empty(len(candidates), np.int64)
    inliers(candidates, rays, inverse, tolerance, counts)
    plane = candidates[counts.argmax()]
    for _ in range(2):
        on = np.abs(equations @ plane - inverse) < tolerance
        plane = np.linalg.lstsq(equations[on], inverse[on], rcond=None)[0]
    return plane


def _extent(rays: Floats, inverse: Floats, on: NDArray[np.bool_]) -> float:
    """Standard deviation of the points in the narrower direction of their plane, in m."""
    depth = 1.0 / inverse[on]
    points = np.stack([rays[0][on] * depth, rays[1][on] * depth, depth])
    spreads = np.sqrt(np.maximum(0.0, np.linalg.eigvalsh(np.cov(points))))
    return float(spreads[1])
