"""Of several joints that were driven, a law is looked for at the one that is followed worst."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis import law_at_a_joint as module
from hydrolek_drake.diagnosis import law_choice, other_laws
from hydrolek_drake.diagnosis.conclusion import Conclusion
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_at_a_joint import followed_worst, law_at_a_joint, left_at
from hydrolek_drake.diagnosis.law_told_anew import Told
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.identification.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rollout.rollout import roll_out

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

MOVING = ("right_j2", "right_j3")
TIME = np.arange(0.0, 5.0, 0.01)
OFF_DEG = {"right_j2": 0.3, "right_j3": 1.0}
NOISE_DEG = 0.05


@pytest.fixture(scope="module")
def experiments(two_joints):
    """Both joints, each moving alone; what `OFF_DEG` says is added to the reading of each."""
    rng = np.random.default_rng(2)
    signals = {}
    for i, joint in enumerate(MOVING):
        volts = np.repeat(rng.uniform(-3.0, 3.0, 10), 50)
        volts[:50] = 0.0
        record = two_joints.records()[i : i + 1]
        reading = roll_out(record, TIME, volts, TIME, longest_step=1e-3).signals.reading
        reading = reading + np.radians(NOISE_DEG) * rng.standard_normal(TIME.size)
        signals[f"{joint}.command"] = volts
        signals[f"{joint}.angle"] = reading + np.radians(OFF_DEG[joint]) * np.sin(2.0 * np.pi * 0.5 * TIME)
    recording = Recording("made", TIME, signals, Path("made.csv"))
    return [replace(e, others=None) for e in experiments_of(two_joints, recording)]


@pytest.fixture(scope="module")
def fitted(two_joints, experiments):
    """Data of both joints, the nominal model after one step, and that one judged."""
    with ThreadPoolExecutor(2) as pool:
        bench = Workbench(two_joints, free_parameters(two_joints), experiments, pool)
        start = {free.path: 1.001 * two_joints.value(free.path) for free in bench.nominal}
        nominal = bench.fit((), start, bench.fine, 1)
        held_out = bench.residuals(nominal, experiments, bench.fine)
        yield bench, Judged(nominal, held_out, sum(e.counted for e in experiments))


def test_what_is_left_at_each_joint_is_what_is_left_in_all(fitted, experiments) -> None:
    _, nominal = fitted
    parts = [left_at(joint, nominal.held_out, experiments) for joint in MOVING]
    assert sum(squares for squares, _ in parts) == pytest.approx(float(nominal.held_out @ nominal.held_out))
    assert [counted for _, counted in parts] == [e.counted for e in experiments]
    assert left_at("left_j2", nominal.held_out, experiments) == (0.0, 0)


def test_the_joint_that_is_followed_worst_is_asked_and_the_rest_is_held(
    fitted, experiments, two_joints, monkeypatch
) -> None:
    bench, nominal = fitted
    asked = {}

    def find_law(one, named, kept, scales):
        asked.update(one=one, named=named, kept=kept, scales=scales)
        law = SimpleNamespace(parameters={"joints.right_j3.command.delay": 0.5})
        return law

    monkeypatch.setattr(module, "find_law", find_law)
    monkeypatch.setattr(module, "replace", lambda law, **new: SimpleNamespace(**{**vars(law), **new}))
    scales = dict.fromkeys(MOVING, SimpleNamespace())
    assert followed_worst(nominal.held_out, experiments, scales) == "right_j3"
    law = law_at_a_joint(bench, nominal.hypothesis, experiments, scales)
    one = asked["one"]
    assert {e.joint for e in (*one.training, *asked["kept"])} == {"right_j3"}
    assert one.nominal and all(free.path.startswith("joints.right_j3.") for free in one.nominal)
    assert asked["scales"] is scales["right_j3"]
    # the rest of the machine, the pump with it, stands where all joints were fitted
    for path, value in nominal.hypothesis.values.items():
        own = path.startswith("joints.right_j3.")
        assert one.rig.value(path) == pytest.approx(two_joints.value(path) if own else value, rel=1e-12)
    assert law.parameters == {**nominal.hypothesis.values, "joints.right_j3.command.delay": 0.5}


def test_without_room_for_a_law_none_is_looked_for(fitted, experiments) -> None:
    bench, nominal = fitted
    assert followed_worst(nominal.held_out, experiments, {}) is None
    assert law_at_a_joint(bench, nominal.hypothesis, experiments, {}) is None


@pytest.mark.parametrize(("off", "asked"), [(0.0, True), (0.5, False)])
def test_while_a_search_goes_on_the_other_joints_must_be_explained(
    fitted, experiments, monkeypatch, off, asked
) -> None:
    """Where they are, the law that explains the joint explains all; where not, none of one joint does."""
    bench, nominal = fitted
    last = experiments[0].time.size
    quiet = nominal.hypothesis.fit.residuals.copy()
    quiet[:last] = off * quiet[:last] + (1.0 - off)
    left = replace(nominal.hypothesis, fit=replace(nominal.hypothesis.fit, residuals=quiet))
    monkeypatch.setattr(Workbench, "residuals", lambda self, hypothesis, *_: hypothesis.fit.residuals)
    law = SimpleNamespace(parameters={})
    asked_at = []

    def question(one, *given):
        asked_at.append(one.training[0].joint)
        return law

    monkeypatch.setattr(module, "replace", lambda law, **new: SimpleNamespace(**{**vars(law), **new}))
    monkeypatch.setattr(other_laws, "told_anew", lambda *_: Told(law, tuple(experiments), tuple(experiments)))
    monkeypatch.setattr(other_laws, "predicting", lambda *_: True)
    monkeypatch.setattr(other_laws, "_explaining", lambda *_: True)
    found = other_laws._at_one_joint(bench, left, experiments, dict.fromkeys(MOVING, None), question)
    assert asked_at == (["right_j3"] if asked else [])
    assert (found is not None) == asked


@pytest.mark.parametrize(("with_law", "told"), [(1.0, True), (30.0, False)])
def test_a_law_is_told_if_all_joints_are_followed_as_well_as_with_the_effects(
    fitted, experiments, monkeypatch, with_law, told
) -> None:
    bench, nominal = fitted
    half = replace(nominal, held_out=0.7 * nominal.held_out)
    conclusion = Conclusion("unlisted_physics", half, {}, ())
    law = SimpleNamespace(joint="right_j3", held_out_over_noise=with_law, law=None, rivals=())
    anew = Told(law, tuple(experiments), tuple(experiments))
    monkeypatch.setattr(law_choice, "law_at_a_joint", lambda *_: law)
    monkeypatch.setattr(law_choice, "told_anew", lambda *_: anew)
    found = law_choice.with_law_at_a_joint(
        bench, conclusion, [nominal], experiments, dict.fromkeys(MOVING), lambda text: None
    )
    assert (found is anew) == told
