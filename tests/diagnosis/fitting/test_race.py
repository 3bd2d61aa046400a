"""A race goes on with what may be right: what a rung does not tell apart ranks by what it promised."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.settings import GAINS, Rung
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
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
        [best] = race(Workbench(bench, free, training, pool, 2), entrants, heats)
    assert [c.id for c in best.effects] == ["load.payload"]
    assert best.fit.over_noise < 1.05
    assert best.values[f"{PAYLOAD}.mass_kg"] == pytest.approx(20.0, rel=0.1)


def test_fits_of_a_structure_in_different_minima_go_on_whichever_promised_more(bench, recorded) -> None:
    """The beginning of the data tells neither from noise: the second is nearer to it by less than it must be."""
    training = recorded(bench, bench)
    drift = next(
        c
        for c in candidates_of(bench, "joint", natural_scales(bench, "joint", training))
        if c.id == "sensor.drift"
    )
    free = [p for p in free_parameters(bench) if p.path.endswith("max_area")]
    still = Rung(math.inf, 1.0, 0.9 * float(training[0].time[-1]), 0, 8, each=8)

    def ended(sizes):
        entrants = [Entrant((drift,), {**drift.starts[0], drift.size_path: size}) for size in sizes]
        return race(Workbench(bench, free, training, pool, 2), entrants, (still,))

    with ThreadPoolExecutor(2) as pool:
        tried = {s: ended([s])[0].fit.objective for s in drift.size.upper * np.geomspace(1e-4, 1.0, 400)}
        least = min(tried.values())
        worse = min((s for s, q in tried.items() if q > least + 4.0), key=lambda s: tried[s])
        better = min(tried, key=lambda s: tried[s])
        assert tried[worse] < least + GAINS.needed
        both = ended([worse, better])
    assert [h.values[drift.size_path] for h in both] == [pytest.approx(worse), pytest.approx(better)]


def test_a_structure_in_other_ranges_or_another_order_stands_where_it_was(bench, recorded) -> None:
    training = recorded(bench, bench)
    scales = natural_scales(bench, "joint", training)
    candidates = {c.id: c for c in candidates_of(bench, "joint", scales)}
    delay, drift = candidates["command.delay"], candidates["sensor.drift"]
    at_end = {delay.size_path: delay.size.upper}
    wide = delay.widened(at_end)
    assert wide.size.upper > delay.size.upper
    beyond = {delay.size_path: 0.9 * wide.size.upper, drift.size_path: 0.1 * drift.size.upper}
    within = {delay.size_path: 0.5 * delay.size.upper, drift.size_path: 0.3 * drift.size.upper}
    entrants = [
        Entrant((wide, drift), beyond),
        Entrant((drift, wide), within),
        Entrant((delay, drift), within),
    ]
    still = Rung(math.inf, 1.0, math.inf, 0, 3, each=3)
    free = [p for p in free_parameters(bench) if p.path.endswith("max_area")]
    with ThreadPoolExecutor(2) as pool:
        ended = race(Workbench(bench, free, training, pool, 2), entrants, (still,))
    stands = sorted((h.values[delay.size_path], h.values[drift.size_path]) for h in ended)
    wanted = sorted((v[delay.size_path], v[drift.size_path]) for v in (beyond, within))
    assert [pytest.approx(each) for each in wanted] == [stands[0], stands[-1]]
