"""Table 7.1 as it is printed, and output sets in volts as appendix F has them."""

import numpy as np
import pytest

from hydrolek_drake.control.comparison.bench import bench_on_models
from hydrolek_drake.control.laws.fuzzy import (
    SETS,
    appendix_f_sets,
    appendix_f_surface,
    fuzzy_data,
    membership,
    printed_surface,
)
from hydrolek_drake.control.thesis_gains import scaled_input

JOINTS = ("j1", "j2", "j3", "j4")
CENTRES = {"NB": -20.0, "N": -4.0, "Z": 0.0, "P": 4.0, "PB": 20.0}
OUTPUT = {"NB": -1.0, "N": -0.25, "Z": 0.0, "P": 0.25, "PB": 1.0}
CHANGES = {"NB": -2.0, "N": -0.6, "Z": 0.0, "P": 0.6, "PB": 2.0}


@pytest.fixture(scope="module")
def steps():
    names = ["fuzzy_double", "fuzzy_double_printed", "fuzzy_appendix_f"]
    return {trial.controller: trial.joints for trial in bench_on_models(names, ["step"]).trials}


@pytest.mark.parametrize("error", SETS)
@pytest.mark.parametrize("change", SETS)
def test_the_surface_at_the_middle_of_two_sets_is_the_cell_of_table_7_1(error, change):
    """The table's error is angle less set point, the surface's set point less angle."""
    errors, changes, surface = printed_surface()
    i = np.argmin(np.abs(errors + np.clip(CENTRES[error], errors[0], errors[-1])))
    j = np.argmin(np.abs(changes + np.clip(CHANGES[change], changes[0], changes[-1])))
    said = fuzzy_data()["table_7_1"][error][SETS.index(change)]
    assert surface[i, j] == pytest.approx(OUTPUT[said], abs=0.02)


def test_a_standing_joint_far_off_moves_no_faster_than_a_near_one_by_table_7_1(steps):
    """(NB, Z) is P, not PB: what stands is started slowly, so the rise is over twice that of rules with PB there."""
    for joint in JOINTS:
        assert (
            steps["fuzzy_double_printed"][joint].step.rise_s > 1.8 * steps["fuzzy_double"][joint].step.rise_s
        )


@pytest.mark.parametrize("joint", JOINTS)
def test_output_sets_are_voltages_beyond_the_joints_own_dead_zone(joint):
    scaling = scaled_input(joint)
    sets = appendix_f_sets(scaling, joint)["output"]
    assert all(corner > scaling.dead_positive_V for corner in (*sets["P"], *sets["PB"]))
    assert all(corner < scaling.dead_negative_V for corner in (*sets["N"], *sets["NB"]))
    assert scaling.dead_negative_V < sets["Z"][0] < 0.0 < sets["Z"][3] < scaling.dead_positive_V
    assert all(list(corners) == sorted(corners) for corners in sets.values())
    _, _, surface = appendix_f_surface(scaling, joint)
    assert surface.min() == pytest.approx(scaling.lowest_V, abs=0.01)
    assert surface.max() == pytest.approx(scaling.highest_V, abs=0.01)


def test_every_error_belongs_to_some_set():
    for sets in (fuzzy_data()["error"], fuzzy_data()["appendix_f"]["error"]):
        values = np.linspace(-30.0, 30.0, 601)
        grades = [membership(values, sets[name]) for name in SETS]
        assert np.max(grades, axis=0).min() >= 0.5 - 1e-9


def test_joint_1_swings_about_the_set_point_as_the_thesis_says_of_its_machine(steps):
    """Section 7.1.3: 'sizeable oscillation at the top of the step movement' of joint 1; no row of Table 7.1 brakes."""
    assert steps["fuzzy_appendix_f"]["j1"].step.ripple_deg > 2.0
    assert steps["fuzzy_double"]["j1"].step.ripple_deg < 0.2
