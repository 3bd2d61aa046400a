"""A law beyond the linkage: M = r(q) F."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.law_counterpart import counterpart
from hydrolek_drake.diagnosis.law_inputs import inputs_of
from hydrolek_drake.diagnosis.law_problem import Law
from hydrolek_drake.diagnosis.laws import Term, law_records, span_of
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.rollout.one_point import law_along, stroke_and_lever

POWERS = tuple(Term((), place=place, speed="sign(v)") for place in ("1", "z", "z^2"))


@pytest.fixture
def moved(bench, recorded):
    """What a machine does, its span and its unknown inputs."""
    experiment = recorded(bench, bench)[0]
    record = bench.records()[0]
    run = experiment.simulate(bench.records()).signals
    scales = natural_scales(bench, "joint", [experiment])
    inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
    return run, record, span_of([run], record, 12.0, "rad"), inputs


def _law(moved, stage: str, values: tuple[float, ...], terms: tuple[Term, ...] = POWERS):
    _, _, span, inputs = moved
    given = next(i for i in inputs if i.stage == stage)
    return SimpleNamespace(law=Law(given, terms, 0.0, 0.0, ()), values=np.array(values), span=span)


def _along(moved, stage: str, values: np.ndarray) -> np.ndarray:
    """A law of powers along the movement."""
    run, record, span, _ = moved
    stroke, lever = np.array([stroke_and_lever(q, record) for q in run.position]).T
    seen = np.stack(
        [
            run.time,
            run.position,
            run.velocity,
            stroke,
            lever * run.velocity,
            *([np.zeros(run.time.size)] * 3),
        ],
        axis=1,
    )
    return sum(law_along(row, seen) for row in law_records(stage, span, POWERS, values))


def test_a_friction_at_the_rod_brakes_the_joint_by_its_lever(moved) -> None:
    run, record, _, inputs = moved
    rod = _law(moved, "cylinder", (-400.0, 150.0, -80.0))
    there, values = counterpart(rod, inputs, [run], record)
    assert (there.input.stage, there.terms) == ("load", POWERS)
    lever = np.array([stroke_and_lever(q, record)[1] for q in run.position])
    wanted = lever * _along(moved, "cylinder", rod.values)
    assert np.ptp(lever) > 0.05 * np.abs(lever).max()  # or the lever would not matter
    np.testing.assert_allclose(_along(moved, "load", values), wanted, atol=0.05 * np.abs(wanted).max())


def test_a_moment_comes_back_from_beyond_the_linkage(moved) -> None:
    run, record, span, inputs = moved
    joint = _law(moved, "load", (-60.0, 20.0, 0.0))
    rod, values = counterpart(joint, inputs, [run], record)
    _, back = counterpart(SimpleNamespace(law=rod, values=values, span=span), inputs, [run], record)
    np.testing.assert_allclose(back, joint.values, atol=0.05 * 60.0)


def test_nothing_else_has_a_counterpart(moved) -> None:
    run, record, _, inputs = moved
    assert counterpart(_law(moved, "supply", (1e5,), (Term(()),)), inputs, [run], record) is None
    assert counterpart(_law(moved, "load", (1.0, 0.0, 2.0), ()), inputs, [run], record) is None
    dry = [i for i in inputs if i.stage != "cylinder"]  # a machine without oil
    assert counterpart(_law(moved, "load", (-60.0, 20.0, 0.0)), dry, [run], record) is None
