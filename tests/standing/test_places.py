"""Where to stand: places that are answered work, places that are refused do not, and left is right's mirror image."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, arm_chain
from hydrolek_drake.standing import reach
from hydrolek_drake.standing.base import Placement, drawn_boom_angle, load_base
from hydrolek_drake.standing.picture import standing_png
from hydrolek_drake.standing.place_file import read_place
from hydrolek_drake.standing.reach import Stage
from hydrolek_drake.standing.report import answer_json
from hydrolek_drake.standing.search import StandingSearch
from hydrolek_drake.standing.site import FLOOR, Site
from hydrolek_drake.teleop.plan import STEPS
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import tool_in_world
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.surroundings import Block

pytestmark = pytest.mark.xdist_group("places to stand")

SITE = Site(make_pipe([2.2, 0.6, 1.06]), -0.05, 0.12)
HERE = Placement(0.33, 0.6, 0.0, drawn_boom_angle())


def _search(site, base, **named):
    return StandingSearch(site, base, generator=np.random.default_rng(1), **named)


@pytest.fixture(scope="module")
def base():
    """A small room, so that few places are looked at."""
    whole = load_base()
    return replace(
        whole,
        x=(0.1, 0.5),
        y=(0.2, 1.0),
        heading=(0.0, 0.0),
        boom=(math.radians(20.0), math.radians(50.0)),
        search={**whole.search, "looked_at": 40, "rounds": 2, "refined": 1, "boom_step": math.radians(30.0)},
    )


@pytest.fixture(scope="module")
def answer(base):
    return _search(SITE, base).answer(2)


def _in_site(placement, point):
    turn, origin = placement.machine_in_site()
    return turn @ point + origin


@pytest.mark.thorough
def test_from_the_places_found_the_tools_come_where_they_should_by_forward_kinematics(answer):
    assert len(answer.standings) == 2 and answer.reason == ""
    blade = kinect_entries("targets")["blade_reach"]
    for standing in answer.standings:
        steps = {step.name: step.trajectory for step in standing.plan.steps}
        assert tuple(steps) == STEPS
        grasp = steps["grasp"].value(steps["grasp"].end_time())[:, 0]
        _, point = tool_in_world(grasp, standing.grasping)
        np.testing.assert_allclose(_in_site(standing.placement, point), SITE.grasp_point(), atol=1e-5)
        tips = []
        for time in np.linspace(0.0, steps["cut"].end_time(), 101):
            turn, point = tool_in_world(
                steps["cut"].value(time)[:, 0], SIDES[1 - SIDES.index(standing.grasping)]
            )
            tips.append(_in_site(standing.placement, point + blade * turn[:, 0]) - SITE.cut_point())
        tips = np.array(tips)
        assert np.linalg.norm(tips, axis=1).min() < 2e-3  # through the place of the cut
        for end in (tips[0], tips[-1]):
            assert np.linalg.norm(np.cross(end, SITE.pipe.axis)) > SITE.pipe.radius


@pytest.mark.thorough
def test_the_margins_told_are_those_of_the_plan(answer, base):
    for standing in answer.standings:
        room = []
        for name, side in (("grasp", standing.grasping), ("cut", standing.plan.cut.side)):
            chain, trajectory = arm_chain(side), standing.plan.steps[STEPS.index(name)].trajectory
            first = 7 * SIDES.index(side)
            for time in np.linspace(0.0, trajectory.end_time(), 101):
                angles = trajectory.value(time)[first : first + 5, 0]
                room.append(min(np.min(angles - chain.lower[:5]), np.min(chain.upper[:5] - angles)))
        assert min(room) == pytest.approx(standing.margins.joint, abs=math.radians(0.1))
        assert standing.plan_margin <= standing.margins.joint + math.radians(0.1)
        assert standing.margins.clearance >= CollisionWorld(None).padding - 1e-9
        assert base.allows(standing.placement)
    assert answer.standings[0].margins.score >= answer.standings[1].margins.score


@pytest.mark.thorough
def test_no_step_of_the_plan_touches_anything_there(answer):
    standing = answer.standings[0]
    around = standing.placement.surroundings((FLOOR,))
    pipe = standing.placement.pipe_seen(SITE.pipe)
    free = CollisionWorld(pipe, padding=0.0, around=around)
    held = CollisionWorld(pipe, padding=0.0, around=around, holding=(standing.grasping,))
    for step in standing.plan.steps:
        world = free if step.name == "approach" else held
        for time in np.linspace(0.0, step.trajectory.end_time(), 25):
            assert world.free(step.trajectory.value(time)[:, 0]), step.name


@pytest.mark.thorough
def test_left_is_the_mirror_image_of_right(base, monkeypatch):
    """Each place for a tilted pipe is one for its mirror image, the arms exchanged.

    Joint 4 alone is no mirror image: it turns beyond 63.9 deg to one side, the same one on both arms (Table 3.2).
    """

    def with_even_joint_4(side):
        chain = arm_chain(side)
        lower, upper = chain.lower.copy(), chain.upper.copy()
        lower[3], upper[3] = -upper[3], upper[3]
        return replace(chain, lower=lower, upper=upper)

    monkeypatch.setattr(reach, "arm_chain", with_even_joint_4)
    site = Site(make_pipe([2.2, 0.6, 1.0], [0.1, 0.4, 1.0]), -0.05, 0.12)
    ours, theirs = _search(site, base), _search(site.mirrored(), replace(base, y=(-1.0, -0.2)))
    count = 0
    for placement in (point.placement for point in ours.coarse_map()[::8]):
        for side, other in (SIDES, SIDES[::-1]):
            one = ours.point(placement, side)
            two = theirs.point(placement.mirrored(), other)
            assert one.stage is two.stage
            count += one.stage is Stage.REACHED
    assert count > 3


@pytest.mark.thorough
def test_the_best_place_s_mirror_image_is_a_place_for_the_other_arm(answer, base):
    standing = answer.standings[0]
    theirs = _search(SITE.mirrored(), base)
    other = SIDES[1 - SIDES.index(standing.grasping)]
    plan = theirs.plan(standing.placement.mirrored(), other)
    assert plan.grasp.side == other
    # the first ways round the pipe that touch nothing may differ, the height of the tools does not
    assert plan.grasp.points[-1][2] == pytest.approx(standing.plan.grasp.points[-1][2])


def test_a_pipe_out_of_any_reach_is_refused_with_the_reason(base):
    answer = _search(Site(make_pipe([2.2, 0.6, 3.2]), -0.05, 0.12), base).answer()
    assert answer.standings == ()
    assert "cannot put its tool at the grasp" in answer.reason and "long at most" in answer.reason


def test_a_grasp_in_reach_with_a_cut_out_of_reach_says_so(base):
    site = Site(make_pipe([2.2, 0.6, 1.06], [0.0, 0.0, 1.0], 0.0375, 2.1), 0.0, 1.04)
    answer = _search(site, base).answer()
    assert answer.standings == ()
    assert Stage.CUT_POINT.told() in answer.reason or Stage.VIEW.told() in answer.reason


def test_a_wall_before_the_pipe_is_named(base):
    wall = Block("wall", np.array([1.85, 0.6, 1.0]), np.array([0.02, 3.0, 2.0]))
    with pytest.raises(InputError, match="wall"):
        _search(replace(SITE, blocks=(wall,)), base).look(HERE, "right")
    _search(SITE, base).look(HERE, "right")  # without it there is a way


def test_where_base_or_boom_would_touch_is_no_place(base):
    box = Block("box", np.array([HERE.x + 0.7, 0.6, 0.1]), np.array([0.45, 0.6, 0.2]))
    search = _search(replace(SITE, blocks=(box,)), base)
    assert search.point(HERE, "right").stage is Stage.BASE
    assert _search(SITE, base).point(HERE, "right").stage is Stage.REACHED
    with pytest.raises(InputError, match=r"base or boom would be -?\d+ mm from box"):
        search.look(HERE, "right")


@pytest.mark.thorough
def test_the_place_is_written_and_read_back_and_drawn(answer, tmp_path):
    import json

    path = tmp_path / "stand.json"
    path.write_text(json.dumps(answer_json(SITE, answer)))
    placement, pipe = read_place(path)
    first = answer.standings[0].placement
    assert placement.x == pytest.approx(first.x, abs=1e-4) and placement.boom == pytest.approx(
        first.boom, abs=1e-4
    )
    np.testing.assert_allclose(pipe.point, SITE.pipe.point)
    assert standing_png(SITE, answer).startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "text", ["", "[]", '{"places": [], "pipe": {}}', '{"places": [{}], "pipe": {}}', "[" * 100000]
)
def test_what_is_no_place_is_refused(tmp_path, text):
    path = tmp_path / "stand.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"stand\.json"):
        read_place(path)
