"""A law that does what a listed effect of another stage does: the effect takes its place."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.elimination import without_each
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.inputs import inputs_of
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.term_forms import TERMS, span_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

SHIFT = "joints.joint.effects.valve.asymmetric_overlap.shift_m"
SHIFTED_M = 4e-5
LISTED = ("valve.asymmetric_overlap", "sensor.drift", "command.delay", "cylinder.coulomb_friction")


def test_a_shifted_null_takes_the_place_of_a_constant_voltage_before_the_amplifier(bench, recorded) -> None:
    training = recorded(bench.with_values({SHIFT: SHIFTED_M}), bench, pressure_noise_Pa=3e4)
    scales = natural_scales(bench, "joint", training)
    candidates = [c for c in candidates_of(bench, "joint", scales) if c.id in LISTED]
    free = [p for p in free_parameters(bench) if p.path.endswith(("max_area", "load.inertia"))]
    signals = training[0].simulate(bench.records()).signals
    span = span_of([signals], bench.records()[0], 12.0, "rad")
    command = next(
        i for i in inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad") if i.stage == "command"
    )
    constant = next(t for t in TERMS if t.name == "1" and t.meant_for(command))
    law = LawTerm(command, constant, "joint", span)
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free, training, pool, 2)
        begun = [Entrant((), {}), Entrant((law,), {law.size_path: 0.02 * command.scale})]
        found = Tried()
        for each in race(work, begun, (replace(work.settings.again, keep=2),)):
            found.keep(each)
        assert found.best.ids == {law.size_path}
        without_each(work, found, candidates)
    assert found.best.ids == {SHIFT}
    assert found.best.values[SHIFT] == pytest.approx(SHIFTED_M, rel=0.1)
