"""The integration step that a structure is rolled out with: contacts and stick-slip need a shorter one."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.rollout import roll_out

PLAY = "linkage.backlash"
"""With 0.047 rad, the largest that is concealed at an arm's first joint."""

UNSEEN = float(np.sqrt(NOISE.above**2 - 1.0))
"""An error so many times the noise leaves a model that is right no farther above it than is surely above."""


def _error(step_share: float, gap: float) -> float:
    """What the step of the integration adds, over the sensor's noise: rms over 40 s of random voltage."""
    rig = load_rig("hydrolek_right_j1")
    joint = rig.joints[0]
    rig = rig.with_values({f"joints.{joint}.effects.{PLAY}.gap_rad": gap})
    times = np.arange(0.0, 40.0, 0.01)
    volts = np.repeat(np.random.default_rng(3).uniform(-8.0, 8.0, 20), 200)
    record, own = rig.records()[:1], rig.value("integration.longest_step")
    told, exact = (
        roll_out(record, times, volts, times, longest_step=step).signals.reading
        for step in (step_share * own, own / 50.0)
    )
    return float(np.sqrt(np.mean((told - exact) ** 2)) / record["sensor"]["noise"][0])


def test_the_step_of_a_play_resolves_its_contacts() -> None:
    assert _error(EFFECTS[PLAY].step_share, 0.047) < UNSEEN


def test_the_rigs_own_step_resolves_a_machine_without_one() -> None:
    assert _error(1.0, 0.0) < UNSEEN


ABRUPT = {PLAY, "cylinder.stribeck_friction", "load.stribeck_friction"}


@pytest.mark.parametrize("effect", sorted(set(EFFECTS) - ABRUPT))
def test_no_other_effect_takes_more_steps(effect) -> None:
    assert EFFECTS[effect].step_share == 1.0
