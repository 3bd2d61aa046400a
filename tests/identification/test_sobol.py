"""Sobol indices against closed forms, and of the bench."""

import json

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.sensitivity.sobol import sobol_of


def _ishigami(unit, a=7.0, b=0.1):
    x = np.pi * (2.0 * unit - 1.0)
    return np.array([np.sin(x[0]) + a * np.sin(x[1]) ** 2 + b * x[2] ** 4 * np.sin(x[0])])


def _each(function):
    return lambda units: [function(unit) for unit in units]


def test_indices_of_the_ishigami_function_are_its_closed_form():
    a, b = 7.0, 0.1
    alone = np.array([0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, 0.0])
    together = b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)  # of the first and the third
    variance = alone.sum() + together
    found = sobol_of(_each(_ishigami), 1, 3, 2048, np.random.default_rng(1))
    np.testing.assert_allclose(found.first[:, 0], alone / variance, atol=0.02)
    total = (alone + np.array([together, 0.0, together])) / variance
    np.testing.assert_allclose(found.total[:, 0], total, atol=0.02)
    assert np.all(found.total_low < total) and np.all(total < found.total_high)
    np.testing.assert_array_equal(found.total_whole, found.total[:, 0])


def test_indices_of_a_signal_are_weighed_by_its_variance_and_kept_by_segment():
    # first half: 3 u0 + u1 at each sample; second half: 10 u1; uniform in the cube, so that variances are slope^2 / 12
    def output(unit):
        return np.concatenate([np.full(10, 3.0 * unit[0] + unit[1]), np.full(10, 10.0 * unit[1])])

    found = sobol_of(_each(output), 2, 2, 1024, np.random.default_rng(2))
    np.testing.assert_allclose(found.total, [[0.9, 0.0], [0.1, 1.0]], atol=0.02)
    np.testing.assert_allclose(found.first_whole, [9.0 / 110.0, 101.0 / 110.0], atol=0.02)


def test_a_run_that_diverges_is_counted_and_changes_nothing_else():
    def output(unit):
        return np.array([unit[0] if unit[0] < 0.99 else np.nan])

    found = sobol_of(_each(output), 1, 2, 256, np.random.default_rng(3))
    assert found.diverged > 0
    np.testing.assert_allclose(found.total[:, 0], [1.0, 0.0], atol=0.1)


def test_a_number_that_is_no_power_of_two_is_refused(capsys):
    with pytest.raises(InputError, match="needs a power of two, such as 128"):
        sobol_of(_each(_ishigami), 1, 3, 100, np.random.default_rng(1))
    assert run(["sensitivity", "joint_bench", "--sobol", "100"]) == 2
    assert "such as 128" in capsys.readouterr().err


def test_by_command_area_matters_more_than_delay_and_all_is_written(tmp_path, capsys):
    parameters = ["--parameter", "valve.max_area_a", "--parameter", "command.delay"]
    arguments = ["--sobol", "16", "--trajectories", "2", "--out", str(tmp_path)]
    assert run(["sensitivity", "joint_bench", *parameters, *arguments]) == 0
    assert "parameters alone explain" in capsys.readouterr().out
    rows = {
        row["path"]: row["sobol"]
        for row in json.loads((tmp_path / "sensitivity_joint.json").read_text())["parameters"]
    }
    assert rows["joints.joint.valve.max_area_a"]["total"] > 10.0 * rows["joints.joint.command.delay"]["total"]
    assert (tmp_path / "sensitivity_joint_sobol.png").read_bytes().startswith(b"\x89PNG")
