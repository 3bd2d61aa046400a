"""Every component in the Diagram, in the compiled rollout and in lanes: one physics."""

import sys
from pathlib import Path

import numpy as np
import pytest
from component_machines import sound

from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.run import Run
from hydrolek_drake.station.step_sizes import sizes_for

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from two_executions import differences

REQUIRED_DEG = 0.02


@pytest.mark.parametrize("name", sound())
@pytest.mark.thorough(but=4)
def test_the_diagram_agrees_with_the_rollout(with_component, name):
    rig = with_component(name)
    [(_, largest)] = differences.compare(rig, 3.0, 0.5 * sizes_for(rig).step, 5)
    assert largest <= REQUIRED_DEG


@pytest.mark.parametrize("name", sound())
@pytest.mark.thorough
def test_a_lane_does_what_the_machine_does_alone(with_component, name, random_volts):
    records = np.repeat(with_component(name).records(), 3)
    records["load"]["inertia"] *= [1.0, 1.1, 0.9]
    times, volts = random_volts(3.0)
    together = roll_out_lanes(
        Run(records[:1], times, volts, times, longest_step=5e-4).of(records), at_once=True
    )
    for place, found in enumerate(together):
        alone = roll_out(records[place : place + 1], times, volts, times, longest_step=5e-4)
        for signal in SIGNALS:
            np.testing.assert_array_equal(getattr(found.signals, signal), getattr(alone.signals, signal))
