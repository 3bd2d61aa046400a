"""Laws of what happens at some places of the stroke or of the movement: frictions, scored bores, worn tracks."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.law_fit import fitted, glance
from hydrolek_drake.diagnosis.law_growing import LONGEST
from hydrolek_drake.diagnosis.law_inputs import Input, inputs_of
from hydrolek_drake.diagnosis.law_problem import Law, records_of
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import Term, law_records, span_of
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.physics.law import NEAR, Seen, law_value
from hydrolek_drake.replay.display import shown

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")


def _inputs(bench, training) -> tuple[Input, ...]:
    """The unknown inputs of the bench's joint."""
    return inputs_of(natural_scales(bench, "joint", training), bench.value("supply.pressure"), 10.0, "rad")


@pytest.mark.long("takes most of a minute")
@pytest.mark.usefixtures("in_less_time", "with_fewer_laws")
def test_a_friction_over_the_stroke_is_found_at_the_rod_as_a_law_of_several_terms(
    bench, recorded, sought
) -> None:
    """F = -(400 N + 2500 N u^2) sign(v), with u from 0 to 1 over the cylinder's whole stroke: no single term of z."""
    dry, tight = 400.0, 2500.0
    stroke = bench.value("joints.joint.cylinder.stroke")

    def planted(experiment):
        run = experiment.simulate(bench.records()).signals
        span = span_of([run], bench.records()[0], 12.0, "rad")
        half, middle = 0.5 * (span.rod.high - span.rod.low), 0.5 * (span.rod.high + span.rod.low)
        terms = (
            Term((), speed="sign(v)"),
            Term((), place="z", speed="sign(v)"),
            Term((), place="z^2", speed="sign(v)"),
        )
        over = tight / stroke**2
        sizes = (-dry - over * middle**2, -2.0 * over * middle * half, -over * half**2)
        return law_records("cylinder", span, terms, sizes)

    training, held_out = (recorded(bench, bench, seed=seed, law=planted) for seed in (1, 2))
    _, judged, found = sought(bench, training, held_out)
    assert judged.over_noise > 2.0
    assert found is not None and found.law.input.stage == "cylinder"
    assert set(found.rivals) <= {"load"}  # which may rub as the rod does
    assert 1 < len(found.law.terms) <= LONGEST
    assert found.held_out_over_noise < 1.1

    def friction(u: float) -> float:
        """At a stroke, as a share of the whole."""
        seen = Seen(0.0, 0.0, 0.0, u * stroke, found.span.rod.speed, 0.0, 0.0, 0.0)
        laws = records_of(found.law, found.span, found.values)
        return -sum(law_value(row, seen) for row in laws)

    low, high = found.span.rod.low / stroke, found.span.rod.high / stroke
    for u in np.linspace(low, high, 7):
        assert friction(u) == pytest.approx(dry + tight * u**2, abs=0.15 * (dry + tight))


@pytest.mark.long("takes a minute")
@pytest.mark.xfail(
    strict=True,
    reason="12 s: it is told at the rod, but by one term of the two, which leaves 1.6 times the noise of the held-out "
    "data; fitted to all of them the two would leave less, and the training data alone do not show that",
)
@pytest.mark.usefixtures("in_less_time")
def test_a_friction_at_one_place_of_the_stroke_is_found_there(bench, recorded, sought) -> None:
    """A scored bore: between two of the places that terms have, and wider than either."""
    place, size = 0.375, 1200.0
    neighbours = tuple(Term((), place=NEAR, speed="sign(v)", centre=at, reach=0.5) for at in (0.25, 0.5))

    plain = recorded(bench, bench, seed=1)[0].simulate(bench.records()).signals
    span = span_of([plain], bench.records()[0], 12.0, "rad")
    scored = law_records("cylinder", span, neighbours, (-0.5 * size, -0.5 * size))
    peak = span.rod.low + 0.5 * (1.0 + place) * (span.rod.high - span.rod.low)

    kept = {"pressure_noise_Pa": 2e4, "law": lambda _: scored}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    beside, judged, found = sought(bench, training, held_out)
    assert judged.over_noise > 2.0
    assert found is not None and found.law.input.stage == "cylinder"
    law = Law(found.law.input, neighbours, 0.0, 0.0, ())
    begin = ({}, law.begun(np.array([-0.5 * size, -0.5 * size])))
    with ThreadPoolExecutor(2) as pool:
        again = Workbench(bench, free_parameters(bench), beside.training, pool)
        right = fitted(
            again,
            judged.hypothesis,
            law,
            held_out,
            span,
            begin,
            again.fine,
        )
    assert found.held_out_over_noise < 1.1 * right.held_out_over_noise
    reach = found.span.rod
    strokes = np.linspace(reach.low, reach.high, 41)
    laws = records_of(found.law, found.span, found.values)
    moving = [Seen(0.0, 0.0, 0.0, stroke, reach.speed, 0.0, 0.0, 0.0) for stroke in strokes]
    friction = np.array([-sum(law_value(row, seen) for row in laws) for seen in moving])
    assert strokes[np.argmax(friction)] == pytest.approx(peak, abs=0.125 * (reach.high - reach.low))


@pytest.mark.usefixtures("in_less_time")
def test_where_a_bore_is_scored_and_how_far_is_fitted(bench, recorded) -> None:
    """Between two of the places where a search begins, and narrower than it begins."""
    size, centre, reach = 1500.0, 0.35, 0.3
    plain = recorded(bench, bench, seed=1)[0].simulate(bench.records()).signals
    span = span_of([plain], bench.records()[0], 12.0, "rad")
    rubbing = Term((), place=NEAR, speed="sign(v)", centre=centre, reach=reach)
    scored = law_records("cylinder", span, (rubbing,), (-size,))
    kept = {"pressure_noise_Pa": 2e4, "law": lambda _: scored}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        inputs = _inputs(bench, training)
        rod = next(given for given in inputs if given.stage == "cylinder")
        for start in (0.25, 0.5):
            begun = replace(rubbing, centre=start, reach=0.5)
            law = Law(rod, (begun,), 0.0, 0.0, (-0.05,))
            at = glance(workbench, nominal, law, span, 2.0 * workbench.fine)[1:]
            found = fitted(workbench, nominal, law, held_out, span, at, workbench.fine)
            assert found.values == pytest.approx([-size, centre, reach], rel=0.05), start
            assert found.held_out_over_noise < 1.1
    stroke = span.rod.high - span.rod.low
    assert found.names == [
        f"near({shown(span.rod.low + 0.5 * (1.0 + found.values[1]) * stroke, 'm')}, "
        f"{shown(0.5 * found.values[2] * stroke, 'm')}) sign(v)"
    ]


@pytest.mark.usefixtures("in_less_time")
def test_a_track_that_is_worn_at_one_place_is_found_at_the_sensor(bench, recorded) -> None:
    """Narrower than a search begins, and between two of its places."""
    size, centre, reach = 0.015, 0.06, 0.18
    plain = recorded(bench, bench, seed=1)[0].simulate(bench.records()).signals
    span = span_of([plain], bench.records()[0], 12.0, "rad")
    worn = law_records("sensor", span, (Term((), place=NEAR, centre=centre, reach=reach),), (size,))
    kept = {"pressure_noise_Pa": 2e4, "law": lambda _: worn}
    training, held_out = (recorded(bench, bench, seed=seed, **kept) for seed in (1, 2))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        nominal = fit_baseline(workbench)
        inputs = _inputs(bench, training)
        laws = promising(workbench, nominal, inputs, span, 4.0 * workbench.fine)
        best = max(laws, key=lambda law: law.gain)
        assert nominal.fit.over_noise > 2.0
        assert best.input.stage == "sensor"
        at = glance(workbench, nominal, best, span, 2.0 * workbench.fine)[1:]
        found = fitted(workbench, nominal, best, held_out, span, at, workbench.fine)
    assert found.held_out_over_noise < 1.1
    assert found.values == pytest.approx([size, centre, reach], rel=0.05)
