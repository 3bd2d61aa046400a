"""Impossible parameters give an Outcome with a reason and NaN, never an exception, never a silent number."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import kernel, rest_state, roll_out

TIMES = np.arange(0.0, 1.0, 0.01)
VOLTS = 8.0 * np.sign(np.sin(7.0 * TIMES))


def _roll(records):
    return roll_out(records, TIMES, VOLTS, TIMES, longest_step=5e-4)


def _signals(outcome):
    return np.array([getattr(outcome.signals, name) for name in kernel.SIGNALS])


def _parameters(name):
    rig = load_rig(name)
    return [path for path in rig.entries if not path.startswith("integration.")]


def _set(records, path, value):
    section, _, name = path.rpartition(".")
    if ".effects." in path:
        records["effects"][section.split(".effects.")[1].replace(".", "_")][name] = value
    else:
        records[section.split(".")[-1]][name] = value


def test_a_simulation_that_runs_away_says_when_and_leaves_nan_from_there(bench):
    records = bench.records()
    records["load"]["damping"] = -3e5  # pumps energy in
    records["load"]["stop_damping"] = 0.0
    outcome = _roll(records)
    assert outcome.diverged is not None and "left all bounds at" in outcome.diverged
    signals = _signals(outcome)
    row = np.argmax(np.isnan(signals[1]))
    assert 0 < row < len(TIMES)
    assert np.isnan(signals[:, row:]).all()
    assert np.isfinite(signals[:, :row]).all()
    assert f"{TIMES[row]:.3f} s" in outcome.diverged


def test_a_spool_that_runs_away_is_seen_although_the_joint_stays_finite(bench):
    records = bench.records()
    records["solenoid"]["spring"] = -8e4
    outcome = _roll(records)
    assert outcome.diverged is not None
    assert np.isnan(_signals(outcome)[:, -1]).all()


@pytest.mark.parametrize("rig_name", ["joint_bench", "festo_tp511", "patu_lift", "emps"])
def test_any_nan_parameter_is_named_and_gives_nan(rig_name):
    rig = load_rig(rig_name)
    for path in _parameters(rig_name):
        records = rig.records()
        _set(records, path, np.nan)
        outcome = _roll(records)
        assert outcome.diverged is not None, path
        assert path.rpartition(".")[2] in outcome.diverged
        assert np.isnan(_signals(outcome)).all(), path


@pytest.mark.parametrize("rig_name", ["joint_bench", "festo_tp511", "patu_lift", "emps"])
@pytest.mark.filterwarnings("error")
def test_no_parameter_set_to_zero_raises(rig_name):
    rig = load_rig(rig_name)
    for path in _parameters(rig_name):
        records = rig.records()
        _set(records, path, 0.0)
        outcome = _roll(records)
        finite = np.isfinite(_signals(outcome)).all()
        assert finite == (outcome.diverged is None), path


@pytest.mark.parametrize(
    "path", ["joints.joint.load.inertia", "fluid.density", "joints.joint.linkage.direction"]
)
def test_division_by_zero_is_an_outcome_that_says_so(bench, path):
    records = bench.records()
    _set(records, path, 0.0)
    outcome = _roll(records)
    assert outcome.diverged == "a parameter by which something is divided is zero"
    assert np.isnan(_signals(outcome)).all()


def test_a_nan_in_the_command_is_an_outcome_too(bench):
    volts = VOLTS.copy()
    volts[40] = np.nan
    outcome = roll_out(bench.records(), TIMES, volts, TIMES, longest_step=5e-4)
    assert outcome.diverged is not None
    assert np.isfinite(outcome.signals.position[:40]).all()
    assert np.isnan(outcome.signals.position[-1])


def test_the_start_is_not_written_to(bench):
    records = bench.records()
    start = rest_state(records)
    kept = start.copy()
    roll_out(records, TIMES, VOLTS, TIMES, longest_step=5e-4, state=start)
    np.testing.assert_array_equal(start, kept)


def test_times_that_do_not_rise_are_refused():
    records = load_rig("joint_bench").records()
    backwards = TIMES[::-1]
    with pytest.raises(InputError, match="command times must rise"):
        roll_out(records, backwards, VOLTS, TIMES, longest_step=5e-4)
    with pytest.raises(InputError, match="the times must rise"):
        roll_out(records, TIMES, VOLTS, backwards, longest_step=5e-4)
    with pytest.raises(InputError, match="99 command values"):
        roll_out(records, TIMES, VOLTS[:-1], TIMES, longest_step=5e-4)
