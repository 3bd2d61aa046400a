"""Which recording would decide between effects that the present ones cannot tell apart.

Every proposal is checked by simulation: one hypothesis plays the machine, the other tries to explain it with
all its parameters (linearised), and what it cannot explain, in units of the noise, is what the recording would
show.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.evidence.judged import Conclusion
from hydrolek_drake.diagnosis.fitting.problems import hypothesis_of
from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.settings import EXPERIMENTS, GAINS
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.channel import Channel
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import with_slopes
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.rolling import Request, residuals_at


@dataclass(frozen=True)
class Proposal:
    """An experiment that was checked by simulation.

    Attributes:
        sentence: what to do, and what it would show.
        time: of the command's samples [s]. # (n,)
        command: to be driven, or what was driven before [V]. # (n,)
        separation: what the wrong hypothesis could not explain, in standard deviations.
    """

    sentence: str
    time: np.ndarray
    command: np.ndarray
    separation: float


def commands_of(amplitude: float) -> dict[str, np.ndarray]:
    """Commands to choose from: words -> voltage every 10 ms over 40 s. # (n,) each."""
    time = np.arange(0.0, EXPERIMENTS.duration_s, EXPERIMENTS.sample_s)

    def steps(levels: Sequence[float], hold: float) -> np.ndarray:
        return np.array(levels)[(time / hold).astype(int) % len(levels)]

    shapes = {
        "small steps to and fro, 2 s each, with rests": steps([0.0, 0.35, 0.0, -0.35], 2.0),
        "large steps to and fro, 1.5 s each, with rests of 1.5 s": steps([0.0, 1.0, 0.0, -1.0], 1.5),
        "a staircase of rising steps to and fro, 1 s each": steps(
            [0.0, 0.3, -0.3, 0.45, -0.45, 0.6, -0.6, 0.8, -0.8, 1.0, -1.0], 1.0
        ),
        "a slow sine of 20 s": 0.6 * np.sin(2.0 * math.pi * time / 20.0),
        "fast reversals, a sine of 2 s": 0.8 * np.sin(2.0 * math.pi * time / 2.0),
        "short moves, each followed by 8 s of rest": steps(
            [0.8, 0.0, 0.0, 0.0, 0.0, -0.8, 0.0, 0.0, 0.0, 0.0], 2.0
        ),
    }
    return {words: amplitude * shape for words, shape in shapes.items()}


def propose(bench: Workbench, conclusion: Conclusion, hypotheses: Sequence[Hypothesis]) -> Proposal | None:
    """The experiment that tells the two most probable hypotheses apart best; None if there is only one.

    Args:
        bench: data and fits.
        conclusion: with its groups.
        hypotheses: fitted, the most probable first.
    """
    if (
        len(hypotheses) < 2
        or conclusion.verdict not in ("ambiguous", "missing_physics")
        or not conclusion.groups
    ):
        return None
    first, second = hypotheses[0], hypotheses[1]
    template = bench.training[0]
    neutral = bench.rig.value(f"joints.{template.joint}.command.neutral")
    amplitude = float(np.abs(template.command - neutral).max())
    away = f"up to {amplitude:.3g} V" + (f" away from {neutral:.3g} V" if neutral else "")
    options: list[tuple[str, Experiment]] = []
    hydraulic = bench.rig.is_hydraulic(template.joint)
    unrecorded = hydraulic and len(template.channels) == 1
    if unrecorded:
        options.append(
            ("the same command with both chamber pressures recorded", _with_pressures(bench, template))
        )
    for words, command in commands_of(amplitude).items():
        experiment = _with_command(template, neutral + command)
        options.append((f"{words} ({away})", experiment))
        if unrecorded:
            options.append((f"{words} ({away}), with both chamber pressures recorded",
                            _with_pressures(bench, experiment)))  # fmt: skip
    seen = _separations(bench, first, second, [experiment for _, experiment in options])
    ranked = sorted(zip(seen, options, strict=True), key=lambda pair: -pair[0])
    separation, (words, experiment) = ranked[0]
    names = " from ".join(_names(h) for h in (first, second))
    told = (
        f"it would tell {names} at {separation:.0f} standard deviations (checked by simulation)"
        if separation >= GAINS.certain
        else f"even it would tell {names} only at {separation:.1f} standard deviations"
    )
    return Proposal(
        f"Drive {experiment.joint} with {words}: {told}.", experiment.time, experiment.command, separation
    )


def _names(hypothesis: Hypothesis) -> str:
    return " + ".join(c.id for c in hypothesis.effects) or "the nominal model"


def _with_command(template: Experiment, command: np.ndarray) -> Experiment:
    time = np.arange(command.size) * EXPERIMENTS.sample_s
    channels = tuple(
        replace(channel, measured=np.zeros(command.size), model_error=None, blur=None, timing=None)
        for channel in template.channels
    )
    return replace(
        template, name="proposal", time=time, command_times=time, command=command, channels=channels,
        used=np.ones(command.size, dtype=bool), start_response=None,
    )  # fmt: skip


def _with_pressures(bench: Workbench, experiment: Experiment) -> Experiment:
    """The same with both chamber pressures, at the noise that the rig states, or 0.2 % of the supply."""
    stated = bench.rig.value(f"joints.{experiment.joint}.sensor.pressure_noise")
    noise = stated if stated > 0.0 else 0.002 * bench.rig.value("supply.pressure")
    nothing = np.zeros(experiment.time.size)
    more = tuple(
        Channel(f"{experiment.joint}.{name}", "Pa", name, nothing, noise)
        for name in ("pressure_a", "pressure_b")
    )
    position = replace(experiment.channels[0], measured=nothing, model_error=None, timing=None)
    return replace(experiment, channels=(position, *more), start_response=None)


def _separations(
    bench: Workbench, truth: Hypothesis, rival: Hypothesis, experiments: Sequence[Experiment]
) -> list[float]:
    """Root of the squared residuals that the rival leaves of each after its best (linear) change of parameters."""
    played = residuals_at(
        [
            Request(problem, (problem.parameters.unit(truth.values),))
            for problem in (
                bench.problem(truth.effects, bench.step_for(truth.effects), [e]) for e in experiments
            )
        ],
        bench.pool,
        bench.cores,
    )
    places = []
    for experiment in experiments:
        problem = bench.problem(rival.effects, bench.step_for(rival.effects), [experiment])
        unit = problem.parameters.unit(rival.values)
        places.append(Place(problem, bench.movable(rival.effects, problem.parameters), unit, exact=True))
    found = []
    for place, (shown,) in zip(with_slopes(places, bench.pool, bench.cores), played, strict=True):
        assert place.residuals is not None and place.slopes is not None
        fit = hypothesis_of(rival.effects, place, bench.step_for(rival.effects)).fit
        across = Across(replace(fit, slopes=place.slopes))
        unchanged = np.zeros_like(fit.off_prior)
        found.append(float(np.linalg.norm(across(np.concatenate([place.residuals - shown, unchanged])))))
    return found
