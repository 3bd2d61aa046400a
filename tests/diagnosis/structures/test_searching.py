"""What is planted is found and nothing else, nothing where nothing is, and an interrupt leaves an answer."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.inquiry import INTERRUPTED, Answer
from hydrolek_drake.diagnosis.structures.answering import Inquiry
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

SHIFTED = {"valve.max_area": 1.08, "fluid.bulk_modulus": 0.9, "supply.pressure": 1.05}
"""By how much the machine's own numbers differ from the rig's."""

FRICTION_N = 600.0
SHAKING_NM, SHAKING_HZ = 60.0, 1.3


@pytest.fixture
def answer_of(bench, recorded):
    """(planted values, how it was recorded, told) -> the answer for a machine with other numbers than the rig."""

    def make(planted: dict[str, float], say=lambda text: None, **how) -> Answer:
        own = {path: by * bench.value(path) for path, by in _present(bench).items()}
        machine = bench.with_values({**own, **planted})
        training, held_out = (
            recorded(machine, bench, seed=seed, pressure_noise_Pa=3e4, **how) for seed in (1, 2)
        )
        scales = natural_scales(bench, "joint", training)
        candidates = candidates_of(bench, "joint", scales)
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool)
            return Inquiry(candidates, {"joint": scales}, apart=True, say=say, cores=2).answer(
                workbench, held_out
            )

    return make


def _present(rig) -> dict[str, float]:
    """Of the numbers that differ those that the rig lets free."""
    free = [each.path for each in free_parameters(rig)]
    return {path: by for end, by in SHIFTED.items() for path in free if path.endswith(end)}


def test_a_machine_that_lacks_nothing_is_told_so(answer_of) -> None:
    answer = answer_of({})
    assert answer.conclusion.verdict == "none"
    assert answer.conclusion.best.hypothesis.effects == ()
    assert answer.conclusion.best.over_noise < 1.1


@pytest.mark.long("takes half a minute")
def test_a_planted_friction_is_found_with_its_size(answer_of) -> None:
    path = "joints.joint.effects.cylinder.coulomb_friction.coulomb_N"
    answer = answer_of({path: FRICTION_N})
    best = answer.conclusion.best
    assert answer.conclusion.verdict == "missing_physics"
    assert [c.id for c in best.hypothesis.effects] == ["cylinder.coulomb_friction"]
    assert best.hypothesis.values[path] == pytest.approx(FRICTION_N, rel=0.05)
    assert best.over_noise < 1.1


@pytest.mark.long("loops over lanes with laws are compiled first")
def test_what_shakes_the_load_is_told_as_a_law_there(answer_of) -> None:
    answer = answer_of({}, unknown=("load", SHAKING_NM), unknown_Hz=SHAKING_HZ)
    assert answer.conclusion.verdict == "unlisted_physics"
    assert answer.law is not None and answer.law.law.input.stage == "load"
    assert answer.law.values[2] == pytest.approx(SHAKING_HZ, abs=0.01)
    assert answer.law.amplitudes[0] == pytest.approx(SHAKING_NM, rel=0.1)
    assert answer.law.held_out_over_noise < 1.1


@pytest.mark.parametrize("at", [2])
def test_an_interrupt_leaves_the_best_answer_so_far(answer_of, at) -> None:
    told: list[str] = []

    def say(text: str) -> None:
        told.append(text)
        if len(told) == at:
            raise KeyboardInterrupt

    answer = answer_of({"joints.joint.effects.cylinder.coulomb_friction.coulomb_N": FRICTION_N}, say)
    assert INTERRUPTED in answer.remarks
    assert len(told) >= at
    assert answer.known.judged


def test_settings_are_one_frozen_object() -> None:
    from hydrolek_drake.diagnosis.structures.settings import Settings

    with pytest.raises(AttributeError):
        Settings().beam = 3  # type: ignore[misc]
    assert replace(Settings(), beam=3).beam == 3
