"""What touches and what does not."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.kinematics.inverse import inverse_position
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import with_arm
from hydrolek_drake.workcell.scene import home_posture


def test_nothing_touches_at_home(clear):
    assert clear.free(home_posture()) and not clear.touching(home_posture())


def test_arms_turned_inwards_touch_each_other(clear):
    posture = home_posture()
    posture[0], posture[7] = np.radians(25), np.radians(-25)
    assert not clear.free(posture)
    assert all({a.split("_")[0], b.split("_")[0]} == {"left", "right"} for a, b in clear.touching(posture))

    said, count = clear.what_touches(posture), len(clear.touching(posture))
    assert count > 2 and said.endswith(f"and {count - 2} other pairs") and said.count("link") <= 4


def test_a_hand_on_the_pipe_touches_it_unless_it_holds_it(clear, holding, pipe):
    point = in_frame(pipe.point, given_in="world", wanted_in="right_base")
    posture = with_arm(home_posture(), "right", inverse_position(point).nearest())
    assert not clear.free(posture)
    assert all("pipe" in pair for pair in clear.touching(posture))
    touching = holding.touching(posture)
    assert ("pipe", "right_link6") not in touching and ("pipe", "right_jaw") not in touching


def test_padding_is_the_distance_that_counts_as_touching(pipe):
    """The hand is moved towards the pipe until it touches: with 30 mm of padding, some 30 mm earlier."""
    ahead = in_frame(pipe.point, given_in="world", wanted_in="right_base")

    def first_touch(world):
        for back in np.arange(0.3, 0.0, -0.004):
            result = inverse_position(ahead - [back, 0, 0], explain=False)
            if result.reached and not world.free(with_arm(home_posture(), "right", result.angles[0])):
                return back
        raise AssertionError("never touched")

    bare, padded = CollisionWorld(pipe, padding=0.0), CollisionWorld(pipe, padding=0.03)
    assert 0.015 < first_touch(padded) - first_touch(bare) < 0.05


def test_posture_of_one_arm_only_is_refused(clear):
    with pytest.raises(InputError, match="14 finite"):
        clear.free(np.zeros(7))
