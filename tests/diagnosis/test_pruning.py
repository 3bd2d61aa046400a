"""What is found is held against less: without an effect, and with the special case of one."""

from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import POLISH
from hydrolek_drake.diagnosis.growing import gain_needed
from hydrolek_drake.diagnosis.search import Search, _prune, _widen
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

COULOMB = 600.0


@contextmanager
def _searched(bench, experiments):
    """A workbench, every candidate, and Stribeck and Coulomb friction among them."""
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
    known = {c.id: c for c in candidates}
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free_parameters(bench, ["load.gravity_cos"]), experiments, pool)
        yield work, candidates, *(known[f"cylinder.{name}_friction"] for name in ("stribeck", "coulomb"))


def test_coulomb_friction_is_tried_where_stribeck_friction_was_found(bench, recorded) -> None:
    machine = bench.with_values({"effects.cylinder.coulomb_friction.coulomb_N": COULOMB})
    with _searched(bench, recorded(machine, bench)) as (work, candidates, stribeck, coulomb):
        found = Search()
        found.keep(work.fit((stribeck,), stribeck.starts[0], work.fine, POLISH))
        general = found.best
        _prune(work, found, general, candidates)
    special = found.hypotheses[frozenset({coulomb.size_path})]
    assert special.values[coulomb.size_path] == pytest.approx(COULOMB, rel=0.02)
    # two parameters more gain no more than chance
    assert special.fit.objective - general.fit.objective < gain_needed(special.fit)
    assert found.best.ids == special.ids


STRIBECK = {"coulomb_N": 600.0, "stribeck_N": 900.0, "stribeck_velocity_m_per_s": 0.006}


def test_stribeck_friction_is_tried_from_where_coulomb_friction_was_found(bench, recorded) -> None:
    path = "effects.cylinder.stribeck_friction"
    machine = bench.with_values({f"{path}.{name}": value for name, value in STRIBECK.items()})
    with _searched(bench, recorded(machine, bench)) as (work, candidates, stribeck, coulomb):
        found = Search()
        found.keep(work.fit((coulomb,), coulomb.starts[0], work.fine, POLISH))
        special = found.best
        _widen(work, found, special, candidates)
    wider = found.hypotheses[frozenset({stribeck.size_path})]
    assert found.best.ids == wider.ids
    assert special.fit.objective - wider.fit.objective > gain_needed(special.fit)
    for name, value in STRIBECK.items():
        assert wider.values[f"{stribeck.path}.{name}"] == pytest.approx(value, rel=0.1)
