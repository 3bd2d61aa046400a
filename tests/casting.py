"""Pipes before the camera by ray casting, with colour, for exact comparisons."""

import numpy as np

from hydrolek_drake.vision.camera import recorded_camera


def cast_pipe(point, axis, radius, *, wall=None, brightness=1.0, noise=0.0, seed=0):
    """Colour and depth (mm) of an endless pipe, before a wall at depth `wall` or before nothing."""
    camera = recorded_camera()
    v, u = np.mgrid[0 : camera.height, 0 : camera.width]
    rays = camera.point(np.stack([u, v], axis=-1), 1.0)
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    square = rays - (rays @ axis)[..., None] * axis
    offset = np.asarray(point) - (np.asarray(point) @ axis) * axis
    a, b, c = np.sum(square**2, -1), square @ offset, offset @ offset - radius**2
    root = b * b - a * c
    hit = root >= 0
    depth = np.where(hit, (b - np.sqrt(np.maximum(root, 0))) / a, 0.0)
    if wall is not None:
        depth = np.where(hit, depth, wall)
    if noise:
        depth = depth + np.random.default_rng(seed).normal(0.0, 1.0, depth.shape) * noise * depth**2
    grey = np.where(hit, 170, 60) * brightness
    colour = np.repeat(grey[..., None], 3, axis=-1).round().astype(np.uint8)
    return colour, (np.maximum(depth, 0) * 1e3).round().astype(np.uint16), hit


def cast_crossing(shift):
    """A pipe from left to right beyond a nearer one that stands; its right half set back by `shift` m.

    Returns:
        Colour, depth (mm), and which pixels are the left half's and the right half's.
    """
    left = cast_pipe([0.0, 0.0, 1.2], [1, 0, 0], 0.05, wall=1.6, noise=0.0015, seed=0)
    right = cast_pipe([0.0, 0.0, 1.2 + shift], [1, 0, 0], 0.05, wall=1.6, noise=0.0015, seed=1)
    near = cast_pipe([0.0, 0.0, 0.8], [0, 1, 0], 0.04, noise=0.0015, seed=2)
    on_left = np.broadcast_to(np.arange(640) < 320, near[2].shape)
    depth = np.where(near[2], near[1], np.where(on_left, left[1], right[1]))
    colour = np.where(near[2][..., None], near[0], np.where(on_left[..., None], left[0], right[0]))
    return colour, depth, left[2] & on_left & ~near[2], right[2] & ~on_left & ~near[2]
