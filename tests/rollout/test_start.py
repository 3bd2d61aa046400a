"""Where a rollout starts: at rest, in balance, and where the sensor was read."""

import numpy as np
import pytest

from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.rest import rest_state_at_reading, rest_tilt_and_lead
from hydrolek_drake.rollout.rollout import roll_out

READING = 0.7
TIMES = np.arange(0.0, 1.0, 0.01)


@pytest.mark.parametrize(
    "effect",
    [
        {},
        {"base.compliance": {"stiffness_Nm_per_rad": 3e4, "inertia_kg_m2": 20.0}},
        {"sensor.nonlinearity": {"amplitude_rad": 0.05}},
        {"linkage.backlash": {"gap_rad": 0.02}},
    ],
    ids=lambda effect: next(iter(effect), "none"),
)
def test_the_model_begins_where_the_sensor_was_read_and_stays_there(bench, effect) -> None:
    values = {f"effects.{name}.{key}": v for name, own in effect.items() for key, v in own.items()}
    records = bench.with_values(values).records()
    state = rest_state_at_reading(records, READING)
    quiet = roll_out(records, TIMES, np.zeros(TIMES.size), TIMES, state=state, longest_step=5e-4)
    assert quiet.signals.reading[0] == pytest.approx(READING, abs=1e-9)
    if "linkage.backlash" not in effect:  # the bench begins with its play centred, out of contact
        assert np.abs(quiet.signals.reading - READING).max() < np.radians(0.02)


def test_a_leaning_base_is_allowed_for(bench) -> None:
    stiffness = 3e4
    values = {
        "effects.base.compliance.stiffness_Nm_per_rad": stiffness,
        "effects.base.compliance.inertia_kg_m2": 20.0,
    }
    records = bench.with_values(values).records()
    position = rest_state_at_reading(records, READING)[4]
    # gravity leans the base by its moment over the stiffness, which the sensor does not see as the joint's angle
    lean = bench.value("load.gravity_cos") * np.cos(position) / stiffness
    assert abs(position - READING) == pytest.approx(lean, rel=1e-6)


@pytest.mark.parametrize("slight", [-2e-14, 0.0, 2e-14, -1.0, 1.0])
def test_a_play_that_next_to_nothing_presses_is_not_taken_up(bench, slight) -> None:
    record = bench.with_values(
        {"effects.linkage.backlash.gap_rad": 0.02, "linkage.play_taken_up": 1.0}
    ).records()[0]
    assert rest_tilt_and_lead(record, READING, slight)[1] == READING
    assert rest_tilt_and_lead(record, READING, 50.0)[1] > READING + 0.01 - 1e-9


def test_noise_of_a_start_in_balance_does_not_choose_the_side_of_a_play() -> None:
    """The wrist begins where its weight has no lever: a start read 0.02 deg off would press a play to either side."""
    gap, off = 0.01, np.radians(0.02)
    rig = load_rig("hydrolek_right_j4", {"joints.right_j4.effects.linkage.backlash.gap_rad": str(gap)})
    records = rig.records()
    for reading in (-off, 0.0, off):
        state = rest_state_at_reading(records, reading)
        assert state[9] == pytest.approx(reading, abs=1e-3 * gap)


def test_nothing_is_driven_before_the_first_command_has_arrived(bench) -> None:
    """A recording may begin with a command: what stood at rest was not driven before."""
    delay, volts = 0.1, 6.0
    records = bench.with_values({"command.delay": delay}).records()
    at_once = roll_out(records, TIMES, np.full(TIMES.size, volts), TIMES, longest_step=5e-4).signals
    waited = np.where(TIMES < delay - 1e-9, 0.0, volts)
    prompt = bench.with_values({"command.delay": 0.0}).records()
    later = roll_out(prompt, TIMES, waited, TIMES, longest_step=5e-4).signals
    assert np.ptp(at_once.position[TIMES < delay]) < 1e-6
    assert at_once.position == pytest.approx(later.position, abs=1e-7)
    assert np.ptp(at_once.position) > np.radians(10.0)
