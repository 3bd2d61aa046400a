"""The smallest size that would have been seen: planted, it shows; a fifth of it does not."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.intervals.visible import visible_sizes
from hydrolek_drake.diagnosis.search.openings import opened
from hydrolek_drake.diagnosis.settings import GAINS
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

PLANTED = {
    "cylinder.cross_port_leakage": "conductance_m3_per_s_Pa",
    "cylinder.coulomb_friction": "coulomb_N",
    "valve.null_leakage": "conductance_m3_per_s_Pa",
    "valve.spool_stiction": "force_N",
    "fluid.entrained_air": "air_fraction",
    "sensor.hysteresis": "half_width_rad",
}


SIMPLIFIED = 0.8
"""Rate of a drift [rad/min], as if the equations erred by it; far more than would be seen."""


@pytest.fixture(scope="module")
def healthy(bench, recorded, fitted):
    """Squared residuals of the fitted nominal model, and the smallest sizes that would have been seen."""
    experiments = recorded(bench, bench, seed=5)
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free_parameters(bench), experiments, pool, 2)
        nominal = fitted(work)
        candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
        simplified = [replace(c, beneath=SIMPLIFIED if c.id == "sensor.drift" else 0.0) for c in candidates]
        promises = opened(work, nominal, "effects", simplified, Tried()).free
        return nominal, {v.candidate.id: v.size for v in visible_sizes(work, nominal, promises)}


@pytest.mark.parametrize("effect_id", PLANTED)
@pytest.mark.thorough(but=1)
def test_a_size_that_would_be_seen_is_not_made_up_for_by_the_nominal_model(
    bench, recorded, fitted, healthy, effect_id
) -> None:
    nominal, sizes = healthy

    def gain(share: float) -> float:
        size = share * sizes[effect_id]
        machine = bench.with_values({f"effects.{effect_id}.{PLANTED[effect_id]}": size})
        with ThreadPoolExecutor(2) as pool:
            work = Workbench(bench, free_parameters(bench), recorded(machine, bench, seed=5), pool, 2)
            again = fitted(work, (), nominal.values)
        return again.fit.objective - nominal.fit.objective

    # the noise adds to the root of a gain, or takes from it, one standard deviation of 1
    assert gain(2.0) ** 0.5 > GAINS.visible**0.5 - 2.0
    assert max(gain(0.2), 0.0) ** 0.5 < GAINS.visible**0.5 + 2.0


def test_friction_that_rises_at_rest_is_seen_by_what_it_adds_to_coulomb_friction(healthy) -> None:
    _, sizes = healthy
    assert sizes["cylinder.stribeck_friction"] > 0.1 * sizes["cylinder.coulomb_friction"]


def test_no_size_is_seen_that_the_equations_simplify(healthy) -> None:
    assert healthy[1]["sensor.drift"] == SIMPLIFIED
