"""A number of the nominal model that does what an effect of its stage does: a dead time beside a dead time."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.search.standing_in import standing_in
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import Free

OWN = "joints.joint.command.delay"


@pytest.fixture
def begun(bench, recorded):
    """(dead time of the machine, what of it is the rig's own) -> starts without the effect that holds the rest."""

    def make(delay: float, own: float):
        experiments = recorded(bench.with_values({OWN: delay}), bench, noise_deg=0.01)
        candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
        longer = next(c for c in candidates if c.id == "command.delay")
        with ThreadPoolExecutor(2) as pool:
            work = Workbench(bench, (Free(OWN, 0.01, 0.5, log=True),), experiments, pool)
            return standing_in(work, Entrant((), {OWN: own}), longer)

    return make


def test_a_fit_without_a_longer_dead_time_begins_at_a_longer_one(begun) -> None:
    [start] = begun(0.2, 0.16)
    assert start.effects == ()
    assert start.values == {OWN: pytest.approx(0.16 * 1.25)}


def test_it_begins_nowhere_else_where_the_effect_does_nothing(begun) -> None:
    assert begun(0.2, 0.2 - 1e-6) == []
