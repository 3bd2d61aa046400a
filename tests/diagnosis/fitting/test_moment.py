"""A load that is picked up between the moments at which fits begin, which no slope of its mass at another one tells."""

import math
from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.settings import Rung
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

MASS, MOMENT = (f"joints.joint.effects.load.payload.{name}" for name in ("mass_kg", "time_s"))


@pytest.mark.parametrize("begun_s", [4.0, 9.0, 11.0])
def test_a_load_is_found_from_a_start_at_another_moment(bench, recorded, begun_s) -> None:
    training = recorded(bench.with_values({MASS: 12.0, MOMENT: 7.23}), bench, pressure_noise_Pa=3e4)
    free = free_parameters(bench)
    payload = next(
        c
        for c in candidates_of(bench, "joint", natural_scales(bench, "joint", training))
        if c.id == "load.payload"
    )
    begun = Entrant((payload,), {**payload.starts[0], MOMENT: begun_s})
    rung = Rung(0.3, 1.0, math.inf, 12, 1, elsewhere=True)
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free, training, pool, 2)
        [found] = race(work, [begun], (rung,))
    assert found.fit.over_noise < 1.05
    assert found.values[MOMENT] == pytest.approx(7.23, abs=0.05)
    assert found.values[MASS] == pytest.approx(12.0, rel=0.05)
