"""The score test: it sees what is planted, and nothing where nothing is."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.fitting.projection import gain_of
from hydrolek_drake.diagnosis.fitting.promise import promises_at
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.openings import opened
from hydrolek_drake.diagnosis.settings import GAINS
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.parameter_set import free_parameters

NOMINAL = ["supply.pressure", "valve.max_area_a", "load.gravity_cos", "amplifier.max_current_a"]


@pytest.fixture
def promises_of(bench, fitted):
    """Experiments -> what every effect promises beside the nominal model, the most promising first."""

    def make(experiments):
        with ThreadPoolExecutor(2) as pool:
            work = Workbench(bench, free_parameters(bench, NOMINAL), experiments, pool, 2)
            candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
            return opened(work, fitted(work), "effects", candidates, Tried()).free

    return make


def test_nothing_is_seen_where_nothing_is(bench, recorded, promises_of) -> None:
    # chance of more than 12 for one parameter: 0.05 %; some twenty effects, some of them at two or three sizes
    assert promises_of(recorded(bench, bench, seed=4))[0].gain < GAINS.needed + 4.0


@pytest.mark.parametrize(
    ("effect_id", "parameter"),
    [("cylinder.cross_port_leakage", "conductance_m3_per_s_Pa"), ("sensor.nonlinearity", "amplitude_rad")],
)
@pytest.mark.thorough(but=1)
def test_the_visible_size_is_where_the_gain_says_it_is(
    bench, recorded, promises_of, effect_id, parameter
) -> None:
    nothing = {s.candidate.id: s for s in promises_of(recorded(bench, bench, seed=5))}
    size = 2.0 * nothing[effect_id].visible_from
    machine = bench.with_values({f"effects.{effect_id}.{parameter}": size})
    seen = {s.candidate.id: s for s in promises_of(recorded(machine, bench, seed=5))}
    # twice the visible size: four times its gain, within the scatter of noise of three deviations
    expected = 4.0 * GAINS.visible
    assert abs(seen[effect_id].gain ** 0.5 - expected**0.5) < 3.5


def test_where_long_steps_diverge_promises_are_told_with_the_rig_s_own(bench, recorded, fitted) -> None:
    """A machine on a hard base runs away in steps of some milliseconds: nothing would promise anything."""
    rig = bench.with_values({"effects.base.compliance.stiffness_Nm_per_rad": 3e6})
    experiments = recorded(rig.with_values({"effects.cylinder.coulomb_friction.coulomb_N": 400.0}), rig)
    own = experiments[0].longest_step
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(rig, free_parameters(rig, NOMINAL), experiments, pool, 2)
        structure = fitted(work)
        problem = work.problem((), own)
        place = Place(problem, work.movable((), problem.parameters), structure.fit.unit, exact=True)
        [place] = descend([place], 0, pool, 2)
        candidates = [
            c
            for c in candidates_of(rig, "joint", natural_scales(rig, "joint", experiments))
            if c.id == "cylinder.coulomb_friction"
        ]
        told = problem.parameters.unit(structure.values)
        left = [float(np.linalg.norm(work.problem((), k * own).residuals(told))) for k in (1.0, 2.0, 4.0)]
        assert min(left[1:]) > 100.0 * left[0]
        [promise] = promises_at(work, place, (), candidates)
    assert promise.gain > GAINS.needed
    assert work.step_for((), 4.0) == own


def test_a_change_with_which_the_rollout_diverged_promises_nothing() -> None:
    rest, good = np.array([1.0, -2.0, 2.0]), np.array([-0.5, 1.0, -1.0])
    assert gain_of(good, rest) == pytest.approx(9.0)
    assert gain_of(-good, rest) == 0.0
    for bad in (np.nan, np.inf):
        assert gain_of(np.array([-0.5, bad, bad]), rest) == 0.0
