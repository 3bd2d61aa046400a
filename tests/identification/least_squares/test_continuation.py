"""Fits by continuation: a chain that is cut where it was measured, and over a horizon that grows."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit import fit_rig
from hydrolek_drake.identification.least_squares.continuation import FOLLOWED, Continuation, spread_evenly
from hydrolek_drake.identification.least_squares.least_squares import fit_from
from hydrolek_drake.identification.parameter_set import Free, ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

SHARED = Path(__file__).parents[4] / "shared" / "recordings" / "hopsan_link"

TRUE = {
    "supply.displacement": "29 cm^3/rev",
    "supply.relief_time": "12 ms",
    "supply.relief_slope": "3e8 Pa s/m^3",
    "supply.relief_hysteresis": "4 bar",
    "supply.initial_pressure": "118 bar",
    "supply.initial_relief": "0.1",
    "load.mass": "23 kg",
}
"""A machine that its rig describes but for these numbers."""


@pytest.fixture(scope="module")
def recording():
    """A link whose pump's line rings."""
    return recorded(TRUE, seconds=3.0)


def recorded(numbers: dict[str, str], seconds: float) -> Recording:
    """A link with other numbers under random steps, with noise."""
    rng = np.random.default_rng(5)
    time = np.arange(0.0, seconds, 0.01)
    volts = np.repeat(rng.uniform(-3.0, 3.0, 10), 30)
    volts[:20] = 0.0
    machine = load_rig("hopsan_link", numbers)
    done = roll_out(machine.records(), time, volts, time, longest_step=2.5e-4).signals
    signals = {
        "joint.command": volts,
        "joint.angle": done.reading + rng.normal(0.0, 8e-4, time.size),
        "joint.pressure_a": done.pressure_a + rng.normal(0.0, 2e4, time.size),
        "joint.pressure_b": done.pressure_b + rng.normal(0.0, 2e4, time.size),
        "supply.pressure": done.supply_pressure + rng.normal(0.0, 2e4, time.size),
    }
    return Recording("link", time, signals, "link.csv")


def test_behind_the_cut_nothing_depends_on_the_supply(recording) -> None:
    rig = load_rig("hopsan_link")
    (experiment,) = experiments_of(rig, recording)
    part = experiment.cut_at_supply().behind_cut()
    assert [c.model for c in part.channels] == ["reading", "pressure_a", "pressure_b"]
    parameters = ParameterSet(rig, free_parameters(rig))
    unit = parameters.unit()
    supply = np.array([path.startswith("supply.") for path in parameters.paths])
    problem = Problem(parameters, [part])
    own = problem.residuals(unit)
    assert np.array_equal(problem.residuals(np.where(supply, 0.3, unit)), own)
    assert not np.array_equal(problem.residuals(np.where(supply, unit, 0.3)), own)
    assert part.cut_at_supply() is part


def test_before_the_cut_nothing_depends_on_the_supply_s_pressure() -> None:
    """The supply under the flow that is drawn of it is at the noise with its own numbers.

    A pressure that is off stays the supply's own, so that the signals behind the cut stay as they are. The relief valve
    is one that does not stick: where one does depends on all before.
    """
    numbers = {**TRUE, "supply.relief_hysteresis": "0 bar"}
    rig = load_rig("hopsan_link", numbers)
    (experiment,) = experiments_of(rig, recorded(numbers, seconds=3.0))
    cut = experiment.cut_at_supply()
    assert [c.model for c in cut.before_cut().channels] == ["supply_pressure"]
    assert cut.cut_at_supply() is cut and cut.uncut().cut is None
    records = rig.records()
    own = cut.simulate(records, 2.5e-4).signals
    left = cut.before_cut().residuals(own)
    # 300 values tell the noise to 4 %, and the recorded pressure, noise included, drives the chambers
    assert np.sqrt(left @ left / cut.before_cut().counted) < 1.15
    other = load_rig("hopsan_link", {**numbers, "supply.displacement": "24 cm^3/rev"})
    off = cut.simulate(other.records(), 2.5e-4).signals
    assert np.array_equal(off.pressure_a, own.pressure_a) and np.array_equal(off.reading, own.reading)
    rise = 3e8 * (29.0 - 24.0) * 1e-6 * rig.value("supply.speed") / (2.0 * np.pi)  # slope times flow
    assert np.abs(off.supply_pressure - own.supply_pressure).max() > 0.9 * rise
    whole = cut.uncut().simulate(records, 2.5e-4).signals
    assert np.array_equal(whole.reading, experiment.simulate(records, 2.5e-4).signals.reading)


@pytest.mark.thorough
def test_what_the_pump_lacks_is_found_with_the_supply_and_not_behind_the_cut() -> None:
    """A pump that gives a fifth: the effect stands in the joint's part of a rig and acts on the supply."""
    lacking = "joints.joint.effects.supply.pump_loss.fraction"
    recording = recorded({**TRUE, lacking: "0.8"}, seconds=3.0)
    rig = load_rig("hopsan_link", {path: text for path, text in TRUE.items() if path == "load.mass"})
    supply = [
        "supply.relief_time",
        "supply.relief_slope",
        "supply.relief_hysteresis",
        "supply.initial_pressure",
    ]
    free = [*free_parameters(rig, [*supply, "load.damping"]), Free(lacking, 0.0, 0.95)]
    parameters = ParameterSet(rig, free)
    experiments = tuple(experiments_of(rig, recording))
    with ThreadPoolExecutor(1) as pool:
        unit = Continuation(parameters, experiments, pool, 1).from_the_cut([parameters.unit()])
    assert unit is not None
    assert parameters.values(unit)[lacking] == pytest.approx(0.8 + 0.2 / 30.0, abs=0.01)  # of 30 cm^3, not 29


@pytest.mark.long("ten seconds")
def test_what_rings_is_found_over_a_horizon_that_grows(recording) -> None:
    """Free rollouts from the rig's own numbers end in another local minimum; led part by part they reach the noise."""
    rig = load_rig("hopsan_link", {path: text for path, text in TRUE.items() if path == "load.mass"})
    supply = [path for path in rig.free_parameters() if path.startswith("supply.")]
    parameters = ParameterSet(rig, free_parameters(rig, [*supply, "load.damping"]))
    experiments = tuple(experiments_of(rig, recording))
    with ThreadPoolExecutor(1) as pool:
        place = Continuation(parameters, experiments, pool, 1).from_starts([parameters.unit()])
    assert np.sqrt(place.objective / place.problem.counted) < 1.1
    assert fit_from(Problem(parameters, experiments), parameters.unit()).over_noise > FOLLOWED
    for path in ("supply.displacement", "supply.relief_hysteresis"):
        value = parameters.values(place.unit)[rig.full_path(path)]
        assert value == pytest.approx(load_rig("hopsan_link", TRUE).value(path), rel=0.1)


@pytest.mark.parametrize("size", [1, 2, 8])
def test_starts_fill_the_cube_evenly(size) -> None:
    """The mean of the coordinates and of their squares is that of the cube to within 1/sqrt(count) of random ones."""
    points = spread_evenly(64, size)
    assert points.shape == (64, size) and points.min() >= 0.0 and points.max() < 1.0
    assert np.abs(points.mean(axis=0) - 0.5).max() < 0.5 / np.sqrt(12 * 64) * 4
    assert np.abs((points**2).mean(axis=0) - 1.0 / 3.0).max() < 0.05


@pytest.mark.shared_recordings
@pytest.mark.skipif(not SHARED.is_dir(), reason="the folder ../shared/recordings is not there")
@pytest.mark.long("a minute")
def test_a_machine_of_other_people_s_programs_is_followed_to_the_noise_from_its_data_sheet() -> None:
    rig = load_rig("hopsan_link")
    train, holdout = (
        read_recording(SHARED / f"h01_{part}.csv", rig.columns) for part in ("train", "holdout")
    )
    found = fit_rig(rig, [train], holdout=[holdout])
    assert found.over_noise < 1.15
    assert found.holdout_over_noise is not None and found.holdout_over_noise < 1.15
