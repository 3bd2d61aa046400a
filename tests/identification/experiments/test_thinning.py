"""Recordings that are sampled far faster than a model needs."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.experiments.thinning import STEPS, Blocks, block_size
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout.rollout import roll_out

NOISE = 1e-4


@pytest.fixture(scope="module")
def emps() -> Rig:
    return load_rig("emps_published", {})


def _recorded(rig: Rig, spacing: float, seed: int = 3) -> Recording:
    """2 s of the axis under steps of 2 V, with white noise."""
    time = np.arange(0.0, 2.0, spacing)
    command = np.where(time < 0.5033, 0.0, np.where(time < 1.2, 2.0, -2.0))
    played = roll_out(rig.records(), time, command, time, longest_step=1e-4).signals.reading
    noise = NOISE * np.random.default_rng(seed).standard_normal(time.size)
    return Recording(
        "made", time, {"axis.command": command, "axis.position": played + noise}, Path("made.csv")
    )


@pytest.mark.parametrize(
    ("spacing", "step", "size"),
    [(0.01, 0.5e-3, 1), (0.01, 1e-3, 1), (1e-3, 0.5e-3, STEPS // 2), (1e-3, 1e-3, STEPS), (2e-3, 0.5e-3, 1)],
)
def test_blocks_are_ten_integration_steps_long_or_there_are_none(spacing, step, size):
    assert block_size(np.arange(1000) * spacing, step) == size


def test_a_recording_at_the_models_own_rate_stays_as_it_is_bit_for_bit(emps):
    recording = _recorded(emps, 0.01)
    (experiment,) = experiments_of(emps, recording)
    assert experiment.block == 1
    assert_array_equal(experiment.time, recording.time)
    assert_array_equal(experiment.channels[0].measured, recording.signal("axis.position"))
    assert_array_equal(experiment.command_at_samples, recording.signal("axis.command"))
    assert experiment.channels[0].blur is None
    assert experiment.used.all()


def test_means_of_a_straight_line_lie_on_it_and_blocks_do_not_overlap():
    time = 3.0 + np.arange(101) * 1e-3
    blocks = Blocks(time, 5)
    assert_allclose(blocks.mean(2.0 * time - 1.0), 2.0 * blocks.time - 1.0, rtol=1e-13)
    assert blocks.time[0] == time[0]  # a rollout begins with the first sample
    assert_allclose(np.diff(blocks.time)[1:], 5e-3, rtol=1e-9)
    assert blocks.time.size == 1 + 20


def test_white_noise_falls_with_the_root_of_the_blocks_length():
    values = np.random.default_rng(1).standard_normal(50_001)
    means = Blocks(np.arange(values.size) * 1e-3, 10).mean(values)[1:]
    assert means.std() == pytest.approx(1.0 / np.sqrt(10.0), rel=0.03)


def test_missing_values_are_left_out_and_gaps_give_no_block():
    time = np.concatenate([np.arange(41), np.arange(100, 141)]) * 1e-3
    values = np.where(np.arange(time.size) < 11, np.nan, 7.0)
    values[12] = np.nan
    blocks = Blocks(time, 10)
    means = blocks.mean(values)
    assert np.isnan(means[:2]).all()
    assert_array_equal(means[2:], 7.0)
    assert not ((blocks.time > 0.041) & (blocks.time < 0.1)).any()


def test_blur_is_the_difference_between_mean_and_middle_of_a_parabola():
    time = np.arange(301) * 1e-3
    blocks = Blocks(time, 10)
    parabola = 40.0 * time**2
    means = blocks.mean(parabola)
    off = np.abs(means - 40.0 * blocks.time**2)
    assert_allclose(blocks.blur(means)[2:-1], off[2:-1], rtol=0.02)


def test_a_thinned_recording_keeps_the_edges_of_its_command_and_fits_to_its_noise(emps):
    recording = _recorded(emps, 1e-3)
    (experiment,) = experiments_of(emps, recording)
    assert experiment.block == STEPS
    assert_array_equal(experiment.command, recording.signal("axis.command"))
    assert experiment.time.size == pytest.approx(recording.time.size / STEPS, abs=2)
    channel = experiment.channels[0]
    assert channel.noise < NOISE
    left = experiment.residuals(experiment.simulate(emps.records(), 1e-4).signals)
    assert left[0] == 0.0
    assert np.sqrt(np.mean(left[1:] ** 2)) < 1.1


def test_command_at_samples_is_what_was_in_force(emps):
    (experiment,) = experiments_of(emps, _recorded(emps, 1e-3))
    told = experiment.command_at_samples
    assert told.size == experiment.time.size
    assert_array_equal(told[experiment.time < 0.503], 0.0)
    assert_array_equal(told[(experiment.time > 0.505) & (experiment.time < 1.199)], 2.0)


def test_repeated_commands_change_nothing_bit_for_bit(emps):
    time = np.arange(0.0, 1.0, 0.01)
    command = np.where(time < 0.3, 0.0, 3.0)
    edges = np.array([0, 30])
    once = roll_out(emps.records(), time[edges], command[edges], time, longest_step=1e-3)
    often = roll_out(emps.records(), time, command, time, longest_step=1e-3)
    assert_array_equal(once.signals.reading, often.signals.reading)
