"""A sine before a second effect is searched for, and any law before a third."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis import law_search
from hydrolek_drake.diagnosis.attempt import attempt, predicting
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.other_laws import OtherLaws
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

RIPPLE_PA, RIPPLE_HZ = 1.5e6, 2.3
TRIED = ("cylinder.coulomb_friction", "fluid.entrained_air", "supply.pressure_droop")
"""Effects that are searched, to spare time: those that make up for most of it."""


def test_a_ripple_of_the_supply_ends_the_search_after_one_effect(bench, recorded, monkeypatch) -> None:
    monkeypatch.setattr(law_search, "HIGHEST_HZ", 4.0)  # a matter of time
    kept = {"largest_V": 7.0, "unknown": ("supply", RIPPLE_PA), "unknown_Hz": RIPPLE_HZ}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    asked = []
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        scales = natural_scales(bench, "joint", training)

        def other(nominal, effects):
            asked.append((nominal, effects))
            return OtherLaws(workbench, held_out, scales)(nominal, effects)

        known = attempt(workbench, candidates_of(bench, "joint", scales), held_out, lambda text: None, other)
    law = known.found.law
    assert asked == [(known.found.baseline, 1)]
    assert law is not None and predicting(law)
    assert law.law.input.stage == "supply"
    assert law.amplitudes == pytest.approx([RIPPLE_PA], rel=0.05)
    assert law.values[2] == pytest.approx(RIPPLE_HZ, abs=0.01)
    assert known.found.rounds == 1
    assert known.conclusion.verdict == "unlisted_physics"


def test_what_does_not_repeat_itself_is_no_ripple(bench, recorded) -> None:
    """Friction and air in the oil at once: no sine promises half of what they leave."""
    rig = bench.with_values(
        {
            "effects.cylinder.coulomb_friction.coulomb_N": 600.0,
            "effects.fluid.entrained_air.air_fraction": 0.05,
        }
    )
    training, held_out = (recorded(rig, bench, seed=seed) for seed in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        scales = natural_scales(bench, "joint", training)
        law = OtherLaws(workbench, held_out, scales)(nominal, 1)
    assert nominal.fit.over_noise > 2.0
    assert law is None
