"""A law at one of two joints that move together: the other one feels it, and answers."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.law_at_a_joint import left_at, one_joint
from hydrolek_drake.diagnosis.law_fit import fitted
from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_problem import Law
from hydrolek_drake.diagnosis.law_told_anew import told_anew
from hydrolek_drake.diagnosis.laws import Reach, Span, law_record
from hydrolek_drake.diagnosis.together import felt_together
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.identification.recorded import experiments_of
from hydrolek_drake.rigs.short_law import terms_of

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

SHAKEN, _ = MOVING = ("right_j2", "right_j3")
SHORT = {"seconds": 6.0, "noise_deg": 0.02}
SHAKING_Nm, SHAKING_Hz = 400.0, 1.3
REACH = Reach(1.0, 1.0, 0.0, 1.0, "rad")
SPAN = Span(REACH, None, 1.0, 1.0, 1.0)
NEARLY_NOISE, FAR_FROM_NOISE = 1.1, 1.3


@pytest.mark.long("takes half a minute")
def test_a_shaken_joint_and_the_one_beside_it_are_explained_by_the_machine_with_the_law(
    two_joints, recorded_together
) -> None:
    rows = law_record("load", SPAN, None, SHAKING_Nm, 0.0, SHAKING_Hz)
    machine = replace(two_joints, laws={SHAKEN: terms_of(rows, ("N m", "rad"), "planted", "planted")})
    # the same voltages twice: so short a recording would tell little of what others do
    training, held_out = (
        felt_together(
            two_joints, experiments_of(two_joints, recorded_together(machine, **SHORT, noise_seed=seed)[0])
        )
        for seed in (1, 2)
    )
    shakes = Law(Input("load", "load", "moment", "N m", 1000.0), (), SHAKING_Hz, 0.0, (0.3, 0.1))
    with ThreadPoolExecutor(2) as pool:
        bench = Workbench(two_joints, free_parameters(two_joints), training, pool)
        nominal = bench.fit((), {}, bench.fine, LOOK)  # bends its numbers to make up for the shaking
        bent = two_joints.with_values(nominal.values)
        bench.training, held_out = (tuple(felt_together(bent, e)) for e in (training, held_out))
        one = one_joint(bench, nominal, held_out, SHAKEN, None)
        begin = ({}, shakes.begun(np.array([300.0, 100.0])))
        found = one.whole(fitted(one.bench, one.nominal, shakes, one.held_out, SPAN, begin, one.bench.fine))
        told = told_anew(bench, nominal, found, held_out)

        def over_noise(experiments):
            residuals = bench.residuals(nominal, experiments, bench.fine)
            squares, counted = left_at(SHAKEN, residuals, experiments)
            rest = sum(e.counted for e in experiments) - counted
            return float(np.sqrt((residuals @ residuals - squares) / rest))

        before = [over_noise(experiments) for experiments in (bench.training, held_out)]
        after = [over_noise(experiments) for experiments in (told.training, told.held_out)]
    assert min(found.fit.over_noise, found.held_out_over_noise, *before) > FAR_FROM_NOISE
    assert max(told.law.fit.over_noise, told.law.held_out_over_noise, *after) < NEARLY_NOISE
    assert told.law.amplitudes[0] == pytest.approx(SHAKING_Nm, rel=0.1)
