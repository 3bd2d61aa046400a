"""A range that proves too narrow is widened, as far as the effect's size can be at all."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.ranges import WIDER, widened
from hydrolek_drake.diagnosis.search import search
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

AIR = "effects.fluid.entrained_air.air_fraction"


@pytest.fixture(scope="module")
def candidates(bench, recorded):
    scales = natural_scales(bench, "joint", recorded(bench, bench))
    return {c.id: c for c in candidates_of(bench, "joint", scales)}


def test_a_range_is_widened_away_from_where_the_effect_is_off(candidates) -> None:
    air, drift, base = (candidates[id_] for id_ in ("fluid.entrained_air", "sensor.drift", "base.compliance"))
    assert widened(air).size.upper == pytest.approx(WIDER * air.size.upper)
    assert widened(air).size.lower == air.size.lower == 0.0
    assert widened(drift).size.upper == pytest.approx(WIDER * drift.size.upper)
    assert drift.size.lower < 0.0
    assert widened(drift).size.lower == pytest.approx(WIDER * drift.size.lower)
    # a base is there the more the softer it is
    assert widened(base).size.lower == pytest.approx(base.size.lower / WIDER)
    assert widened(base).size.upper == base.size.upper
    others = [free for free in widened(base).free if free.path != base.size_path]
    assert others == [free for free in base.free if free.path != base.size_path]


def test_a_range_is_not_widened_beyond_what_can_be_or_what_the_rig_states(
    bench, recorded, candidates
) -> None:
    fade = candidates["amplifier.gain_fade"]
    assert widened(fade).size.upper == 1.0  # more than all of the current cannot be lost
    path = bench.full_path(AIR)
    entries = {**bench.entries, path: replace(bench.entries[path], range=(0.0, 0.01))}
    stated = replace(bench, entries=entries)
    scales = natural_scales(bench, "joint", recorded(bench, bench))
    air = next(c for c in candidates_of(stated, "joint", scales) if c.id == "fluid.entrained_air")
    assert widened(air) == air


def test_more_of_an_effect_than_a_worn_machine_has_is_found_alone(bench, recorded, candidates) -> None:
    air = candidates["fluid.entrained_air"]
    much = 1.6 * air.size.upper
    training = recorded(bench.with_values({AIR: much}), bench, largest_V=7.0, pressure_noise_Pa=2e4)
    told: list[str] = []
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        found = Search()
        search(workbench, [air, candidates["cylinder.coulomb_friction"]], found, told.append)
    assert found.best.ids == {air.size_path}
    assert found.best.fit.over_noise < 1.05
    assert found.best.values[air.size_path] == pytest.approx(much, rel=0.1)
    assert sum("its range was too narrow" in line for line in told) == 1
