"""A load that is picked up at some moment: it is found with its moment, and with how far that is known."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.intervals.last_numbers import intervals_of_moments
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

PAYLOAD = "joints.joint.effects.load.payload"
PICKED_UP = {"mass_kg": 8.0, "time_s": 5.3}


@pytest.mark.long("some seconds")
def test_a_load_is_found_with_the_moment_at_which_it_was_picked_up(answer_of) -> None:
    planted = {f"{PAYLOAD}.{name}": value for name, value in PICKED_UP.items()}
    answer = answer_of(planted, ("load.payload", "cylinder.coulomb_friction"), laws=False, largest_V=5.0)
    best = answer.conclusion.best.hypothesis
    assert [c.id for c in best.effects] == ["load.payload"]
    assert best.values[f"{PAYLOAD}.time_s"] == pytest.approx(PICKED_UP["time_s"], abs=0.05)
    assert best.values[f"{PAYLOAD}.mass_kg"] == pytest.approx(PICKED_UP["mass_kg"], rel=0.1)


def test_the_interval_of_a_moment_holds_it(bench, recorded, fitted) -> None:
    planted = {f"{PAYLOAD}.{name}": value for name, value in PICKED_UP.items()}
    training = recorded(bench.with_values(planted), bench, largest_V=5.0)
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", training))
    payload = next(c for c in candidates if c.id == "load.payload")
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
        found = fitted(workbench, (payload,), planted)
        [(path, known)] = intervals_of_moments(workbench, found).items()
        assert intervals_of_moments(workbench, fitted(workbench, rounds=0)) == {}
    assert path == f"{PAYLOAD}.time_s"
    assert known.low <= PICKED_UP["time_s"] <= known.high
    assert 0.0 < known.high - known.low < 0.5
