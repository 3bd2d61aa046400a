"""What joints that move together do to each other, against the arm's own mechanics and the Drake Diagram."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.neighbours import (
    drawn_flow,
    effects_of_others,
    motion,
    rows_at,
)
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.kinematics.arms import load_of_joint
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station

pytestmark = pytest.mark.xdist_group("joints together")

MOVING = ("right_j2", "right_j3")
TIME = np.arange(0.0, 6.0 + 0.005, 0.01)
RESISTANCE = 5e10


def _column(rows: np.ndarray, name: str) -> np.ndarray:
    return rows[:, PROBES.index(name)]


def test_velocity_and_acceleration_of_a_cubic_are_exact() -> None:
    position, velocity, acceleration = motion(TIME, 0.1 * TIME**3, TIME)
    assert position == pytest.approx(0.1 * TIME**3, abs=1e-9)
    assert velocity == pytest.approx(0.3 * TIME**2, abs=1e-9)
    assert acceleration == pytest.approx(0.6 * TIME, abs=1e-7)


def test_flow_is_the_fed_side_s_area_times_the_speed() -> None:
    record = load_rig("festo_tp511", {}).records()[0]  # the rod drives the slide directly
    sign = float(record["linkage"]["direction"])
    area_a, area_b = (float(record["cylinder"][f"area_{side}"]) for side in "ab")
    flow = drawn_flow(record, np.array([0.1, 0.1]), sign * np.array([0.2, -0.3]))
    assert flow == pytest.approx([0.2 * area_a, 0.3 * area_b])


def test_a_joint_that_moves_alone_feels_nobody(two_joints) -> None:
    assert effects_of_others(two_joints, {"right_j2": (TIME, np.zeros(TIME.size))}) == {}


def test_another_posture_of_the_arm_is_another_gravity(two_joints) -> None:
    here, there = 0.3, -0.4  # rad of joints 2 and 3, both at rest
    still = {joint: (TIME, np.full(TIME.size, q)) for joint, q in zip(MOVING, (here, there), strict=True)}
    rows = effects_of_others(two_joints, still)["right_j2"][1]
    held = {f"right_j{n}": 0.0 for n in range(1, 8)} | dict(two_joints.held)
    real = load_of_joint("right_j2", held | {"right_j3": there})
    record = two_joints.records()[0]["load"]
    assumed = float(record["gravity_cos"]) * np.cos(here) + float(record["gravity_sin"]) * np.sin(here)
    resisting = real.gravity_cos * np.cos(here) + real.gravity_sin * np.sin(here)
    assert abs(resisting - assumed) > 5.0
    assert _column(rows, "load") == pytest.approx(assumed - resisting, abs=1e-6)
    assert _column(rows, "flow") == pytest.approx(0.0, abs=1e-12)


def test_rows_at_another_spacing_lie_on_the_same_lines() -> None:
    rows = np.arange(16.0).reshape(2, 8)
    assert rows_at((0.01, rows), 0.005, 3)[1] == pytest.approx(rows.mean(axis=0))


def test_the_pump_s_effects_belong_to_the_first_joint(two_joints) -> None:
    path = "effects.supply.pressure_droop.resistance_Pa_s_per_m3"
    records = two_joints.with_values({f"joints.right_j2.{path}": RESISTANCE}).records()
    assert (records["effects"]["supply_pressure_droop"]["resistance_Pa_s_per_m3"] == RESISTANCE).all()
    with pytest.raises(InputError, match=r"one pump.*joints\.right_j1\.effects"):
        load_rig("hydrolek", {f"joints.right_j3.{path}": str(RESISTANCE)})


@pytest.mark.thorough
def test_a_shared_pump_that_droops_is_felt_as_in_the_diagram(two_joints) -> None:
    path = "joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3"
    machine = two_joints.with_values({path: RESISTANCE})
    rng = np.random.default_rng(4)
    volts = np.repeat(rng.uniform(-4.0, 4.0, (13, 2)), 50, axis=0)[: TIME.size]
    volts[:50] = 0.0
    station = make_station(machine, command=command_source(TIME, volts))
    angle = run(station, TIME[-1]).signals["reading"][: TIME.size]
    signals = {f"{j}.command": volts[:, i] for i, j in enumerate(MOVING)}
    signals |= {f"{j}.angle": angle[:, i] for i, j in enumerate(MOVING)}
    together = experiments_of(two_joints, Recording("made", TIME, signals, Path("made.csv")))
    for experiment in together:
        errors = []
        for tried in (experiment, replace(experiment, others=None)):
            reading = tried.simulate(machine.records()).signals.reading
            errors.append(np.degrees(np.sqrt(np.mean((reading - experiment.channels[0].measured) ** 2))))
        # what others do is taken from smoothed angles, so a share of it stays
        assert errors[0] < 0.2 * errors[1]


def test_what_is_known_but_roughly_may_leave_its_share_of_the_squared_residuals(two_joints) -> None:
    rng = np.random.default_rng(5)
    volts = rng.uniform(-4.0, 4.0, (TIME.size, 2))
    angle = np.radians(10.0) * np.cumsum(volts, axis=0) / TIME.size
    signals = {f"{j}.command": volts[:, i] for i, j in enumerate(MOVING)}
    signals |= {f"{j}.angle": angle[:, i] for i, j in enumerate(MOVING)}
    experiment = experiments_of(two_joints, Recording("made", TIME, signals, Path("made.csv")))[0]
    channel = experiment.channels[0]
    rough = replace(channel, model_error=np.full(TIME.size, channel.noise))
    together = replace(experiment, channels=(rough,))
    assert experiment.unsure == 0.0
    assert together.unsure == pytest.approx(0.5 * together.counted)  # half of the variance is the model's
    assert together.admitted == 0.0  # which is in the deviations already
    assert (
        replace(together, others=None).unsure == 0.0
    )  # of one that moves alone only the step's error is left
