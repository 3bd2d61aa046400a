"""A load that is picked up at some moment: least squares does not find the moment, going through all of them does."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import GLANCE, LOOK
from hydrolek_drake.diagnosis.growing import LIKELY
from hydrolek_drake.diagnosis.moments import begun, intervals_of_moments, timed
from hydrolek_drake.diagnosis.score import scores_of
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

PICKED_UP = {"mass_kg": 8.0, "time_s": 5.3}


def test_the_moment_of_a_pick_up_is_found_from_a_wrong_one(bench, recorded) -> None:
    machine = bench.with_values({f"effects.load.payload.{name}": value for name, value in PICKED_UP.items()})
    experiments = recorded(machine, bench, largest_V=5.0)
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
    payload = next(c for c in candidates if c.id == "load.payload")
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        step = 2.0 * workbench.fine
        glance = workbench.fit(
            (payload,), {f"{payload.path}.time_s": 7.0, f"{payload.path}.mass_kg": 2.0}, step, GLANCE
        )
        stuck = workbench.refit(glance, step, LOOK, tolerance=1e-4)
        found = timed(workbench, stuck, step)
        known = intervals_of_moments(workbench, found)[f"{payload.path}.time_s"]
        plain = timed(workbench, workbench.fit((), {}, step, GLANCE), step)
    assert stuck.values[f"{payload.path}.time_s"] == 7.0
    assert stuck.fit.over_noise > 2.0
    assert found.fit.over_noise < 1.1
    assert found.values[f"{payload.path}.time_s"] == pytest.approx(PICKED_UP["time_s"], abs=0.05)
    assert found.values[f"{payload.path}.mass_kg"] == pytest.approx(PICKED_UP["mass_kg"], rel=0.1)
    assert known.low <= PICKED_UP["time_s"] <= known.high
    assert 0.0 < known.high - known.low < 0.5
    assert not plain.effects


def test_moments_that_promise_most_come_first(bench, recorded) -> None:
    machine = bench.with_values({f"effects.load.payload.{name}": value for name, value in PICKED_UP.items()})
    experiments = recorded(machine, bench, largest_V=5.0)
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        baseline = workbench.fit((), {}, 2.0 * workbench.fine, 15)
        scores = {s.candidate.id: s for s in scores_of(workbench, baseline, candidates, workbench.fine)}
    payload = scores.pop("load.payload")
    path = payload.candidate.moments[0].path
    assert sorted(m[path] for m in payload.moments) == sorted({s[path] for s in payload.candidate.starts})
    apart = max(np.diff(sorted(moment[path] for moment in payload.moments)))
    nearest = min(abs(moment[path] - PICKED_UP["time_s"]) for moment in payload.moments[:LIKELY])
    assert nearest <= apart
    assert not any(score.moments for score in scores.values())


def test_short_fits_from_moments_far_apart_come_near(bench, recorded) -> None:
    machine = bench.with_values({f"effects.load.payload.{name}": value for name, value in PICKED_UP.items()})
    experiments = recorded(machine, bench, largest_V=5.0)
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
    payload = next(c for c in candidates if c.id == "load.payload")
    others = [c for c in candidates if not c.moments]
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        step = 2.0 * workbench.fine
        near = begun(workbench, (payload,), payload.starts, step)
        kept = begun(workbench, (payload, others[0]), [near], step)
    moments = sorted({start[payload.moments[0].path] for start in payload.starts})
    apart = max(np.diff(moments))
    assert near[payload.moments[0].path] == pytest.approx(PICKED_UP["time_s"], abs=apart)
    assert kept is near  # an effect without a moment begins where it was told to
    assert {free.path for free in payload.moments} == {f"{payload.path}.time_s"}
    assert len(others) == len(candidates) - 1


def test_a_moment_that_promises_little_beside_a_bent_model_is_found(bench, recorded) -> None:
    machine = bench.with_values({f"effects.load.payload.{name}": value for name, value in PICKED_UP.items()})
    experiments = recorded(machine, bench, largest_V=5.0)
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
    payload = next(c for c in candidates if c.id == "load.payload")
    moment = payload.moments[0].path
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), experiments, pool)
        step = 2.0 * workbench.fine
        bent = workbench.fit((), {}, step, LOOK).values
        wrong = [
            {**bent, **start} for start in payload.starts if abs(start[moment] - PICKED_UP["time_s"]) > 3.0
        ]
        near = begun(workbench, (payload,), wrong, step)
    apart = max(np.diff(sorted({start[moment] for start in payload.starts})))
    assert near[moment] == pytest.approx(PICKED_UP["time_s"], abs=apart)
