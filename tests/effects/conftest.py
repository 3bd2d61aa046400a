"""One rollout per set of values, shared between the tests of the effects."""

import numpy as np
import pytest

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

TIMES = np.arange(0.0, 6.0, 0.01)
CHANGES = np.arange(0.0, 6.0, 0.25)
# out to the outer stop, back to the inner one, and small reversals between
VOLTS = np.array([0, 8, 8, 8, 8, 8, 0, -4, -8, -8, -8, -8, -8, -8, -8, -8, 0, 4, -4, 4, -4, 6, 6, 3.0])


@pytest.fixture(scope="session")
def bench():
    """The rig joint_bench; its load's friction is smoothed as its seals' is."""
    return load_rig("joint_bench").with_values({"load.friction_velocity": np.radians(0.2)})


@pytest.fixture(scope="session")
def record(bench):
    """A function: values by path (SI) -> the bench's record."""
    return lambda values: bench.with_values(values).records()[0]


@pytest.fixture(scope="session")
def machine_for(bench):
    """A function: id of an effect -> a rig that it can act on."""
    link = load_rig("hopsan_link")
    return lambda effect_id: link if EFFECTS[effect_id].needs.get("supply") == ("pump",) else bench


@pytest.fixture(scope="session")
def drive(bench):
    """A function: values by path (SI), command, times -> signals; by default a command with all motions."""
    done = {}

    def roll(values=None, command=(CHANGES, VOLTS), times=TIMES, longest_step=5e-4, rig=bench):
        key = (
            tuple((values or {}).items()),
            tuple(map(tuple, command)),
            tuple(times),
            longest_step,
            rig.name,
        )
        if key not in done:
            records = rig.with_values(values or {}).records()
            outcome = roll_out(records, *map(np.asarray, command), times, longest_step=longest_step)
            assert outcome.diverged is None
            done[key] = outcome.signals
        return done[key]

    return roll
