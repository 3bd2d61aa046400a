"""Elementary effects and identifiability on functions that can be solved by hand, and a study of the bench."""

import json

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.identifiability import identifiability
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.sensitivity.morris import elementary_effects, trajectory
from hydrolek_drake.identification.sensitivity.response import response_of
from hydrolek_drake.identification.sensitivity.study import study_sensitivity
from hydrolek_drake.identification.sensitivity.surface import performance_surface, write_surface
from hydrolek_drake.identification.sensitivity.varied import varied_parameters
from hydrolek_drake.rigs import load_rig


def test_a_trajectory_moves_each_parameter_once_within_the_cube():
    points = trajectory(12, np.random.default_rng(0))
    moved = np.diff(points, axis=0)
    assert np.all((moved != 0.0).sum(axis=1) == 1) and np.all((moved != 0.0).sum(axis=0) == 1)
    np.testing.assert_allclose(np.abs(moved[moved != 0.0]), 2.0 / 3.0)
    assert points.min() >= 0.0 and points.max() <= 1.0


def test_effects_of_a_linear_function_are_its_slopes_and_do_not_vary():
    slopes = np.array([3.0, -1.0, 0.0])
    found = elementary_effects(
        lambda units: [np.array([slopes @ u]) for u in units],
        lambda s: np.abs(s),
        3,
        5,
        np.random.default_rng(0),
    )
    np.testing.assert_allclose(found.mean_size[:, 0], np.abs(slopes))
    np.testing.assert_allclose(found.deviation, 0.0, atol=1e-12)


def test_effects_of_a_product_depend_on_the_other_factor():
    found = elementary_effects(
        lambda units: [np.array([u[0] * u[1]]) for u in units],
        lambda s: np.abs(s),
        2,
        400,
        np.random.default_rng(1),
    )
    # the other factor is uniform on {0, 1/3, 2/3, 1}: mean 1/2, deviation sqrt(5/36)
    np.testing.assert_allclose(found.mean_size[:, 0], 0.5, atol=4 * np.sqrt(5 / 36 / 400))
    np.testing.assert_allclose(found.deviation[:, 0], np.sqrt(5 / 36), rtol=0.1)


def test_identifiability_names_what_stands_and_falls_together():
    rng = np.random.default_rng(2)
    a, b = rng.standard_normal((2, 500))
    known = identifiability(("a", "b", "c"), np.column_stack([a, b, b + 1e-3 * a]))
    pairs = {frozenset(pair[:2]) for pair in known.confused}
    assert frozenset(("b", "c")) in pairs
    np.testing.assert_allclose(np.abs(known.directions[-1]), [0.0, np.sqrt(0.5), np.sqrt(0.5)], atol=2e-3)


def test_deviation_is_that_of_least_squares():
    x = np.linspace(-1.0, 1.0, 400)
    known = identifiability(("slope",), x[:, None])
    assert known.deviation[0] == pytest.approx(1.0 / np.sqrt(np.sum(x**2)))


def test_a_parameter_that_does_nothing_is_infinitely_uncertain():
    known = identifiability(("a", "idle"), np.column_stack([np.ones(9), np.zeros(9)]))
    assert np.isinf(known.deviation[1]) and np.isfinite(known.deviation[0])
    assert known.blurred()[0] == {"idle": 1.0}


def test_about_63_parameters_of_a_chain_are_varied_as_in_section_4_3_3():
    varied = varied_parameters(load_rig("hydrolek_right_j2"), "right_j2", 0.2)
    assert 58 <= len(varied.free) <= 70
    assert varied.left_out["joints.right_j2.command.polarity"] == "wiring or noise"


def test_discharge_and_area_of_the_bench_s_valve_cannot_be_told_apart_and_matter_most_where_it_moves():
    paths = ["valve.max_area_a", "valve.discharge", "command.delay"]
    study = study_sensitivity(
        load_rig("joint_bench"), "joint", np.random.default_rng(3), paths=paths, segments=4, trajectories=3
    )
    full = [f"joints.joint.{path}" for path in paths]
    assert study.paths == tuple(full)
    pairs = {frozenset(pair[:2]) for pair in study.known.confused}
    assert frozenset(full[:2]) in pairs  # Q depends on their product alone, equation (4.7)
    assert study.paths[study.ranking[-1]] == full[2]
    nominal = study.response(study.response.parameters.unit())
    assert study.one_at_a_time.outputs.shape == (3, 20, nominal.size)
    assert study.one_at_a_time.spread[0].min() > 0.0


def test_bad_requests_are_refused():
    rig = load_rig("joint_bench")
    with pytest.raises(InputError, match="has no joint 'elbow'"):
        varied_parameters(rig, "elbow", 0.2)
    with pytest.raises(InputError, match="choose a part of the value between 0 and 1"):
        varied_parameters(rig, "joint", 2.0)
    varied = varied_parameters(rig, "joint", 0.2, ["command.delay"])
    with pytest.raises(InputError, match="--segments 0"):
        response_of(rig, "joint", ParameterSet(rig, varied.free), 0, None, np.random.default_rng(0))


def test_a_performance_surface_has_its_valley_where_area_and_flow_trade(tmp_path):
    """Figure 4.11: zero at the rig's own values, and lowest along equal flow per area, since that sets the rate."""
    rig = load_rig("hydrolek_right_j2")
    paths = ("cylinder.area_a", "valve.discharge")
    found = performance_surface(rig, "right_j2", paths, np.random.default_rng(1), places=5)
    assert found.error.shape == (5, 5) and found.error_unit == "deg" and not found.measured
    area, flow = (found.own[i] / found.values[i] for i in (0, 1))
    mixed = np.add.outer(np.log(area), -np.log(flow))  # 0 where discharge per area is the rig's
    along = np.abs(mixed) < 0.25
    assert found.error[along].mean() < 0.5 * found.error[~along].mean()
    pictures = write_surface(found, tmp_path)
    assert pictures[1].read_bytes().startswith(b"\x89PNG")
    assert np.shape(json.loads(pictures[0].read_text())["largest_error"]) == (5, 5)


def test_a_performance_surface_needs_two_parameters():
    rig = load_rig("hydrolek_right_j2")
    with pytest.raises(InputError, match="give two different parameters"):
        performance_surface(rig, "right_j2", ("valve.discharge",) * 2, np.random.default_rng(1))
    with pytest.raises(InputError, match="zero, and the rig gives no range"):
        performance_surface(
            rig, "right_j2", ("valve.discharge", "valve.flow_force"), np.random.default_rng(1)
        )


def test_a_rollout_that_ran_away_counts_neither_way():
    """Of a linear function the slopes are found from the trajectories that are left."""
    slopes = np.array([3.0, -0.5])

    def outputs(points):
        return [np.full(4, np.nan if point[0] > 0.9 else float(slopes @ point)) for point in points]

    def size(signal):
        return np.sqrt((np.nan_to_num(signal) ** 2).mean(axis=-1, keepdims=True))

    found = elementary_effects(outputs, size, 2, 60, np.random.default_rng(2))
    np.testing.assert_allclose(found.mean_size[:, 0], np.abs(slopes), rtol=1e-9)
    np.testing.assert_allclose(found.deviation, 0.0, atol=1e-9)


def test_fewer_values_than_parameters_leave_some_of_them_open():
    found = identifiability(("a", "b", "c"), np.array([[1.0, 0.0, 1.0]]))
    assert found.deviation[0] > 1e6 and found.deviation[2] > 1e6 and np.isinf(found.deviation[1])
    assert len(found.blurred()) == 2
