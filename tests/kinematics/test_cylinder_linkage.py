"""The triangle's equations, and that the chosen mounts can do the arm's work."""

import numpy as np
import pytest
from pydrake.math import RotationMatrix

from hydrolek_drake.kinematics.arms import arm_joint, load_of_joint, make_arms_plant
from hydrolek_drake.kinematics.cylinder_linkage import cylinder_linkages

NAMES = [f"{side}_j{number}" for side in ("right", "left") for number in (1, 2, 3, 5, 7)]
SUPPLY_PRESSURE = 16e6  # Pa, the brief's supply pressure
PAYLOAD = 150.0  # kg at full reach, thesis 3.1


@pytest.fixture(scope="module")
def plant():
    return make_arms_plant()


def _range(plant, name):
    joint = arm_joint(plant, name)
    return np.linspace(joint.position_lower_limit(), joint.position_upper_limit(), 201)


def _distance_through_the_plant(plant, name, angle):
    """Length from pin to pin by the plant's kinematics alone."""
    linkage = cylinder_linkages()[name]
    context = plant.CreateDefaultContext()
    joint = arm_joint(plant, name)
    joint.set_angle(context, angle)
    child = joint.frame_on_child().CalcPose(context, joint.frame_on_parent())
    return np.linalg.norm(child @ linkage.child_point() - linkage.parent_point())


@pytest.mark.parametrize("name", NAMES)
def test_length_is_the_distance_between_the_mounts(plant, name):
    for angle in _range(plant, name)[::40]:
        expected = _distance_through_the_plant(plant, name, angle)
        assert cylinder_linkages()[name].length(angle) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_lever_arm_is_the_derivative_of_the_length(plant, name):
    linkage, step = cylinder_linkages()[name], 1e-5
    angles = _range(plant, name)
    slope = (linkage.length(angles + step) - linkage.length(angles - step)) / (2 * step)
    np.testing.assert_allclose(linkage.lever_arm(angles), slope, rtol=0, atol=1e-9)
    assert np.all(np.sign(slope) == linkage.direction)


@pytest.mark.parametrize("name", NAMES)
def test_linkage_stays_away_from_dead_centre(plant, name):
    included = np.degrees(cylinder_linkages()[name].included_angle(_range(plant, name)))
    assert included.min() >= 25.0 and included.max() <= 155.0


@pytest.mark.parametrize("name", NAMES)
def test_cylinder_can_be_built(plant, name):
    """Dead length (closed length minus stroke) of 80 mm at least; areas in the ranges of Table 4.1."""
    linkage = cylinder_linkages()[name]
    lengths = linkage.length(_range(plant, name))
    stroke = np.ptp(lengths)
    assert lengths.min() - stroke >= 0.08
    assert 500e-6 <= linkage.piston_area() <= 3500e-6
    assert 500e-6 <= linkage.annulus_area() <= 2000e-6
    assert linkage.rod < linkage.bore < linkage.barrel


@pytest.mark.parametrize("number", [1, 2, 3, 5, 7])
def test_left_cylinder_is_the_mirror_image(number):
    right, left = (cylinder_linkages()[f"{side}_j{number}"] for side in ("right", "left"))
    np.testing.assert_allclose(left.parent_point(), right.parent_point() * [1, 1, -1], rtol=0, atol=1e-15)
    np.testing.assert_allclose(left.child_point(), right.child_point() * [1, 1, -1], rtol=0, atol=1e-15)
    angle = 0.3
    mirrored_angle = -angle if number == 1 else angle
    assert left.length(mirrored_angle) == pytest.approx(float(right.length(angle)), abs=1e-15)


@pytest.mark.parametrize(("name", "lifting"), [("right_j2", 1), ("right_j3", 1), ("right_j5", 1)])
def test_supply_pressure_lifts_150_kg_even_at_the_weakest_lever_arm(plant, name, lifting):
    """Largest static moment over all postures against the least torque over the whole stroke."""
    linkage = cylinder_linkages()[name]
    assert linkage.direction == lifting
    available = SUPPLY_PRESSURE * linkage.piston_area() * linkage.lever_arm(_range(plant, name)).min()
    assert available >= _largest_static_moment(plant, name, PAYLOAD)


def _largest_static_moment(plant, name, payload):
    """Over random postures; own angle taken where gravity pulls most, so that it bounds every angle."""
    rng = np.random.default_rng(150)
    others = [f"right_j{number}" for number in range(1, 8) if f"right_j{number}" != name]
    largest = 0.0
    for _ in range(300):
        held = {}
        for other in others:
            joint = arm_joint(plant, other)
            lower, upper = joint.position_lower_limit(), joint.position_upper_limit()
            held[other] = rng.uniform(lower, upper) if np.isfinite(lower) else 0.0
        load = load_of_joint(name, held)
        cosine = load.gravity_cos + payload * load.gravity_cos_per_kg
        sine = load.gravity_sin + payload * load.gravity_sin_per_kg
        largest = max(largest, np.hypot(cosine, sine))
    return largest


def test_lever_arm_converts_force_to_torque_as_the_plant_does(plant):
    """Virtual work: opposite unit forces on the two mounts do the lever arm's work at the joint."""
    name = "right_j2"
    linkage, joint = cylinder_linkages()[name], arm_joint(plant, name)
    angle = 0.4
    turned = RotationMatrix.MakeZRotation(angle) @ linkage.child_point()
    push = (turned - linkage.parent_point()) / linkage.length(angle)
    torque = np.cross(turned, push) @ joint.revolute_axis()
    assert torque == pytest.approx(float(linkage.lever_arm(angle)), abs=1e-12)
