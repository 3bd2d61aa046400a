"""A pump's line that rings: what lies behind its recorded pressure is searched first, and then the supply too."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.fitting.parts import acts_behind, behind_supply, cut
from hydrolek_drake.diagnosis.inquiry import Answer, Inquiry
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig, load_rig

OWN = {
    "supply.displacement": "29 cm^3/rev",
    "supply.relief_time": "8 ms",
    "supply.relief_hysteresis": "4 bar",
    "load.mass": "22 kg",
    "command.delay": "18 ms",
}
"""By what the machine differs from its data sheet."""

FEW = (
    "cylinder.cross_port_leakage",
    "command.delay",
    "supply.pump_loss",
    "sensor.drift",
    "valve.null_leakage",
)
"""A matter of time."""

LEAK = "joints.joint.effects.cylinder.cross_port_leakage.conductance_m3_per_s_Pa"
LOSS = "joints.joint.effects.supply.pump_loss.fraction"


@pytest.fixture(scope="module")
def rig() -> Rig:
    return load_rig("hopsan_link", {})


def played(rig: Rig, planted: dict[str, str], seed: int, seconds: float = 8.0) -> Experiment:
    """A machine under random steps, with the noise that the rig states."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 0.01)
    volts = np.repeat(rng.uniform(-4.0, 4.0, 40), 40)[: time.size]
    volts[:40] = 0.0
    machine = load_rig("hopsan_link", {**OWN, **planted})
    blank = Recording(
        "made", time, {"joint.command": volts, "joint.angle": 0.1 + 1e-3 * volts}, Path("made.csv")
    )
    [experiment] = experiments_of(machine, blank)
    done = replace(experiment, start=None).simulate(machine.records(), 1e-4).signals
    signals = {
        "joint.command": volts,
        "joint.angle": done.reading + rng.normal(0.0, 8e-4, time.size),
        "joint.pressure_a": done.pressure_a + rng.normal(0.0, 2e4, time.size),
        "joint.pressure_b": done.pressure_b + rng.normal(0.0, 2e4, time.size),
        "supply.pressure": done.supply_pressure + rng.normal(0.0, 2e4, time.size),
    }
    [found] = experiments_of(rig, Recording("made", time, signals, Path("made.csv")))
    return found


def asked(rig: Rig, planted: dict[str, str], say: Callable[[str], None] = lambda text: None) -> Answer:
    """What is said of a machine."""
    training, held_out = played(rig, planted, 1), played(rig, planted, 2)
    scales = natural_scales(rig, "joint", [training])
    candidates = [c for c in candidates_of(rig, "joint", scales) if c.id in FEW]
    with ThreadPoolExecutor(2) as pool:
        bench = Workbench(rig, free_parameters(rig), [training], pool, 2)
        inquiry = Inquiry(candidates, {}, apart=True, say=say)
        return inquiry.answer(bench, [held_out])


def test_behind_the_cut_there_is_no_supply(rig) -> None:
    """Neither its numbers nor its signal; effects are on the one side or on the other."""
    experiment = played(rig, {}, 1, seconds=2.0)
    with ThreadPoolExecutor(1) as pool:
        part = behind_supply(Workbench(rig, free_parameters(rig), [experiment.cut_at_supply()], pool, 2))
    assert part is not None
    assert not [free.path for free in part.nominal if free.path.startswith("supply.")]
    assert "supply_pressure" not in [c.model for e in part.training for c in e.channels]
    assert acts_behind(rig, LEAK)
    assert not acts_behind(rig, LOSS)


def test_a_constant_supply_is_not_cut(bench, recorded) -> None:
    """There is nothing that rings."""
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), recorded(bench, bench), pool, 2)
        workbench.training = cut(workbench, workbench.training)
        assert behind_supply(workbench) is None


def test_what_a_recorded_pressure_does_between_samples_is_part_of_the_error(rig) -> None:
    """Every other sample is enough where it is straight; where it rings it is not."""
    experiment = played(rig, {}, 1, seconds=2.0).cut_at_supply()
    spacing, rows = experiment.recorded
    straight = np.linspace(0.0, 1.0, len(rows))[:, None] * np.ones_like(rows)
    for course, differs in ((straight, False), (rows, True)):
        sparse = replace(experiment, recorded=(spacing, course)).with_every_other_of_recorded()
        twice, kept = sparse.recorded
        assert twice == 2.0 * spacing
        between = np.array([np.interp(np.arange(len(rows)) / 2.0, np.arange(len(kept)), c) for c in kept.T]).T
        off = np.max(np.abs(between[: len(rows) - 1] - course[:-1]))
        assert (off > 1e4) == differs


@pytest.mark.thorough
def test_a_leak_behind_the_cut_is_named_and_nothing_else(rig) -> None:
    answer = asked(rig, {LEAK: "2e-12 m^3/(s Pa)"})
    best = answer.conclusion.best.hypothesis
    assert answer.conclusion.verdict == "missing_physics"
    assert [c.id for c in best.effects] == ["cylinder.cross_port_leakage"]
    assert best.values[LEAK] == pytest.approx(2e-12, rel=0.05)


@pytest.mark.thorough
def test_a_pump_that_gives_too_little_is_named_before_the_cut(rig) -> None:
    answer = asked(rig, {LOSS: "0.8"})
    best = answer.conclusion.best.hypothesis
    assert answer.conclusion.verdict == "missing_physics"
    assert [c.id for c in best.effects] == ["supply.pump_loss"]
    assert best.values[LOSS] == pytest.approx(0.8, abs=0.02)


@pytest.mark.thorough
def test_a_machine_that_lacks_nothing_is_told_so(rig) -> None:
    answer = asked(rig, {})
    assert answer.conclusion.verdict == "none"


@pytest.mark.thorough
def test_an_interrupt_behind_the_cut_leaves_an_answer_on_all_of_the_machine(rig) -> None:
    """What was known by then, with the supply's pressure among what it is held against."""

    def interrupted(text: str) -> None:
        if text.startswith("behind the recorded supply pressure: effects"):
            raise KeyboardInterrupt

    answer = asked(rig, {LEAK: "2e-12 m^3/(s Pa)"}, interrupted)
    assert answer.conclusion.verdict == "interrupted"
    assert answer.conclusion.best.hypothesis.effects == ()
    followed = [c.model for e in answer.known.bench.training for c in e.channels]
    assert "supply_pressure" in followed
