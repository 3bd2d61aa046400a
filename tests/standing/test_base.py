"""Tracks and boom: where they bring the plate, and that the collision shapes follow."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import arms_urdf_path
from hydrolek_drake.kinematics.frames import fixed_pose
from hydrolek_drake.standing.base import Placement, drawn_boom_angle, load_base
from hydrolek_drake.standing.clearance import BaseClearance
from hydrolek_drake.standing.site import Site
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.surroundings import Block, boom_pins


def test_the_machine_of_the_workcell_stands_at_the_origin_with_the_boom_as_drawn():
    turn, origin = Placement(0.0, 0.0, 0.0, drawn_boom_angle()).machine_in_site()
    np.testing.assert_allclose(turn, np.eye(3))
    np.testing.assert_allclose(origin, np.zeros(3), atol=1e-15)


def test_the_plate_s_pin_turns_about_the_boom_s_pivot():
    pivot, pin = boom_pins()
    length = np.linalg.norm(pin - pivot)
    for angle in np.radians([5.0, 30.0, 75.0]):
        forward, up = Placement(0.0, 0.0, 0.0, angle).plate_shift()
        moved = pin + np.array([forward, 0.0, up])
        assert np.linalg.norm(moved - pivot) == pytest.approx(length)
        assert math.atan2(moved[2] - pivot[2], moved[0] - pivot[0]) == pytest.approx(angle)


def test_the_urdf_s_base_goes_down_where_the_boom_lifts_the_plate_and_the_arms_stay():
    boom = math.radians(70.0)
    plant = MultibodyPlant(time_step=0.0)
    parser = Parser(plant)
    parser.package_map().AddPackageXml(str(arms_urdf_path().parent / "package.xml"))
    parser.AddModelsFromString(Placement(0.0, 0.0, 0.0, boom).surroundings(()).urdf(), "urdf")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    for frame in ("plate", "right_base", "left_base"):
        pose = plant.GetFrameByName(frame).CalcPoseInWorld(context).GetAsMatrix4()
        np.testing.assert_allclose(pose, fixed_pose("world", frame), atol=1e-12)
    base = plant.GetFrameByName("brokk_base").CalcPoseInWorld(context).translation()
    pivot, pin = boom_pins()
    # the drawn pin stays at the plate, the pivot goes with the base
    to_pin = pin - (base + pivot)
    assert np.linalg.norm(to_pin) == pytest.approx(np.linalg.norm(pin - pivot))
    assert math.atan2(to_pin[2], to_pin[0]) == pytest.approx(boom)
    assert base[2] < -0.05


def test_a_point_seen_from_a_placement_is_where_geometry_says():
    placement = Placement(1.0, 2.0, math.pi / 2, drawn_boom_angle())
    np.testing.assert_allclose(placement.point_seen([1.0, 3.5, 0.8]), [1.5, 0.0, 0.8], atol=1e-12)


def test_base_clearance_is_the_distance_of_a_block_from_the_tracks():
    """The tracks' front is at x = 0.45 m (urdf/hydrolek.urdf)."""
    block = Block("bench", np.array([0.75, 0.0, 0.1]), np.array([0.4, 0.5, 0.2]))
    clearance = BaseClearance(Site(make_pipe(), -0.05, 0.12, (block,)))
    here = Placement(0.0, 0.0, 0.0, drawn_boom_angle())
    distance, what = clearance.of(here, 1.0)
    assert distance == pytest.approx(0.10, abs=1e-6) and what == "bench"
    assert clearance.of(replace(here, x=0.2), 1.0)[0] < 0.0
    # behind the bench, turned round, nothing is near
    assert clearance.of(replace(here, x=-1.0), 0.3) == (0.3, "")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("tracks: {x: {value: [1, -1], unit: m}}", "lower value first"),
        ("tracks: {z: {value: [1, 2], unit: m}}", "z is unknown"),
        ("boom: {angle: {value: [0, 1], unit: m}}", "unit"),
        ("boom: {angle: {value: [0, 120], unit: deg}}", "between -90 and 90"),
        ("tracks: {x: {value: 3, unit: m}}", "lower, upper"),
        ("search: {rounds: {value: .nan, unit: '1'}}", "finite"),
        ("search: {heading_step: {value: 1.0e-6, unit: deg}}", "heading_step"),
        ("wanted: {clearance: {value: 0, unit: mm}}", "positive"),
        ("[]", "give the parts"),
    ],
)
def test_a_bad_base_file_is_refused_in_one_line(tmp_path, text, said):
    path = tmp_path / "base.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        load_base(path)


def test_a_base_file_replaces_what_it_states(tmp_path):
    path = tmp_path / "base.yaml"
    path.write_text("tracks: {x: {value: [-500, 500], unit: mm, source: room}}")
    base, own = load_base(), load_base(path)
    assert own.x == (-0.5, 0.5)
    assert replace(own, x=base.x) == base
