"""Grasp, approach and cut against the pipe that was cast; the cylinder fit against what was planted."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.cylinder import fit_cylinder
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import pipe_targets, pixel_targets

AXES = [(0, 1, 0), (1, 0, 0), (1, 1, 0), (0.2, 1, 0.5), (1, 0.1, -0.4)]


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("distance", [0.8, 1.1, 1.4])
def test_targets_lie_on_the_axis_of_the_pipe(pipe, axis, distance):
    radius, middle = 0.0375, np.array([0.05, -0.02, distance])
    noise = kinect_entries("camera")["depth_noise"]
    colour, depth, _ = pipe(middle, axis, radius, wall=distance + 0.5, noise=noise)
    camera = recorded_camera()
    snapshot = take_snapshot(colour, depth, camera, default_settings())
    click = camera.pixel(middle)
    selected = select_object(snapshot, tuple(click)).mask
    unit = np.array(axis, dtype=float) / np.linalg.norm(axis)
    cut_click = camera.pixel(middle + 0.12 * unit)
    pixels = pixel_targets(snapshot, selected, click, cut_click, camera)
    targets = pipe_targets(snapshot, selected, pixels, camera)
    assert targets.cylinder.radius == pytest.approx(radius, abs=0.004)
    assert np.degrees(np.arccos(abs(targets.cylinder.axis @ unit))) < 1.5
    for point, wanted in ((targets.grasp, middle), (targets.cut, middle + 0.12 * unit)):
        offset = point - wanted
        assert np.linalg.norm(offset - (offset @ unit) * unit) < 0.005  # the 5 mm, for vision alone
        assert abs(offset @ unit) < 0.02  # along the pipe the click decides
    # square to the pipe, clear of it on both sides, in front of it
    assert abs(targets.approach_direction @ targets.cylinder.axis) < 1e-9
    cut = targets.cut_end - targets.cut_start
    assert abs(cut @ targets.cylinder.axis) < 1e-9 and abs(cut @ targets.approach_direction) < 1e-9
    clearance = kinect_entries("targets")["clearance"]
    assert np.linalg.norm(cut) == pytest.approx(2 * (targets.cylinder.radius + clearance))
    assert targets.approach[2] < targets.grasp[2] - targets.cylinder.radius


@pytest.mark.parametrize("axis", [(0, 1, 0), (0.3, 1, 0.4)])
def test_cylinder_fit_recovers_what_was_planted_without_noise(axis):
    rng = np.random.default_rng(1)
    unit = np.array(axis, dtype=float) / np.linalg.norm(axis)
    towards = -np.array([0.1, 0.0, 1.0])
    towards -= (towards @ unit) * unit
    towards /= np.linalg.norm(towards)
    angle, along = rng.uniform(-1.2, 1.2, 800), rng.uniform(-0.2, 0.2, 800)
    around = np.outer(np.cos(angle), towards) + np.outer(np.sin(angle), np.cross(unit, towards))
    centre = np.array([0.1, 0.05, 1.2])
    cylinder = fit_cylinder(centre + 0.05 * around + np.outer(along, unit), rng)
    assert cylinder.radius == pytest.approx(0.05, abs=1e-6)
    assert abs(cylinder.axis @ unit) == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(cylinder.nearest(centre), centre, atol=1e-6)
    assert cylinder.half_length == pytest.approx(0.2, abs=0.01)


def test_a_box_corner_is_no_pipe():
    rng = np.random.default_rng(2)
    a, b = rng.uniform(0, 0.3, 600), rng.uniform(-0.2, 0.2, 600)
    faces = [np.column_stack([a, b, 1.0 + a]), np.column_stack([-a, b, 1.0 + 0 * a])]
    with pytest.raises(InputError, match="no pipe"):
        fit_cylinder(np.vstack(faces), rng)


def test_too_few_points_are_refused():
    with pytest.raises(InputError, match="only 10 depth points"):
        fit_cylinder(np.ones((10, 3)), np.random.default_rng(0))


def test_clicks_outside_the_picture_and_an_object_of_holes_are_refused(pipe):
    colour, depth, hit = pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05)
    camera = recorded_camera()
    snapshot = take_snapshot(colour, depth, camera, default_settings())
    with pytest.raises(InputError, match=r"cut click .* outside"):
        pixel_targets(snapshot, hit, (320, 240), (900, 240), camera)
    holes = take_snapshot(colour, np.zeros_like(depth), camera, default_settings())
    with pytest.raises(InputError, match="all holes"):
        pixel_targets(holes, hit, (320, 240), (320, 100), camera)
