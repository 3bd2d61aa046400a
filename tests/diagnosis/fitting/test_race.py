"""A race goes on with what may be right: what a heat does not tell apart ranks by what it promised."""

import math
from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.fitting.race import Entrant, race
from hydrolek_drake.diagnosis.settings import Rung
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

PAYLOAD = "joints.joint.effects.load.payload"
LATE_S = 8.0
OTHERS = ("sensor.drift", "sensor.hysteresis", "command.delay")


def test_what_the_beginning_does_not_show_goes_on_by_its_promise(bench, recorded) -> None:
    """A load is picked up after the first heat's seconds, so that in these every structure does as well."""
    free = [p for p in free_parameters(bench) if p.path.endswith(("max_area", "load.inertia", "gravity_cos"))]
    training = recorded(
        bench.with_values({f"{PAYLOAD}.mass_kg": 20.0, f"{PAYLOAD}.time_s": LATE_S}), bench, seed=2
    )
    candidates = {c.id: c for c in candidates_of(bench, "joint", natural_scales(bench, "joint", training))}
    promising = candidates["load.payload"]
    entrants = [Entrant((promising,), {f"{PAYLOAD}.mass_kg": 15.0, f"{PAYLOAD}.time_s": LATE_S})]
    entrants += [Entrant((candidates[name],), dict(candidates[name].starts[0])) for name in OTHERS]
    heats = (Rung(math.inf, 1.0, 0.6 * LATE_S, 4, 1), Rung(math.inf, 1.0, math.inf, 12, 1))
    with ThreadPoolExecutor(2) as pool:
        [best] = race(Workbench(bench, free, training, pool), entrants, heats, 2)
    assert [c.id for c in best.effects] == ["load.payload"]
    assert best.fit.over_noise < 1.05
    assert best.values[f"{PAYLOAD}.mass_kg"] == pytest.approx(20.0, rel=0.1)
