"""The two steps and the polish: mechanics with a gain, hydraulics with the mechanics held, then all together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit.rig_objective import RigObjective
from hydrolek_drake.identification.least_squares.least_squares import Fit, multi_start
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.search.search import search
from hydrolek_drake.identification.two_step.gain_rig import gain_path, gain_rig
from hydrolek_drake.identification.two_step.settings import (
    all_ranges,
    hydraulic_ranges,
    mechanical_ranges,
    only_joint,
    two_step_data,
    with_ranges,
)
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig

STAGES = ("nominal", "step one, gain", "step one, hydraulics nominal", "step two", "polish")
"""Models in the order in which they come about; the second has a gain, all others the hydraulics."""

FITTED = ("step one, gain", "step two", "polish")
"""Stages that are the result of a fit."""


@dataclass(frozen=True)
class Stage:
    """A model and how well it follows.

    Attributes:
        name: of `STAGES`.
        rig: the model.
        values: full path -> value of what was fitted; empty where nothing was.
        at_end: paths that ended at an end of their range.
        fitted_deg: rms of measured minus model on the recordings that are fitted.
        held_deg: the same on those held out; None without.
        angles_deg: the model's, recording after recording, fitted ones first. # (n,) each
        evaluations: simulations of all recordings that it took.
    """

    name: str
    rig: Rig
    values: dict[str, float]
    at_end: tuple[str, ...]
    fitted_deg: float
    held_deg: float | None
    angles_deg: tuple[np.ndarray, ...]
    evaluations: int


@dataclass(frozen=True)
class TwoStep:
    """The course of a two-step identification.

    Attributes:
        joint: its name.
        stages: those that were finished.
        noise_deg: of the recorded angle.
        experiments: recordings as they were followed, fitted ones first.
        held: how many of them, at the end, were held out.
        interrupted: whether Ctrl-C ended it early.
    """

    joint: str
    stages: list[Stage] = field(default_factory=list)
    noise_deg: float = 0.0
    experiments: tuple[Experiment, ...] = ()
    held: int = 0
    interrupted: bool = False

    @property
    def rig(self) -> Rig:
        """The best rig with hydraulics so far."""
        return next(stage.rig for stage in reversed(self.stages) if stage.name != STAGES[1])


def identify_two_step(
    rig: Rig,
    recordings: Sequence[Recording],
    *,
    holdout: Sequence[Recording] = (),
    starts: int | None = None,
    polish: bool = True,
    seed: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> TwoStep:
    """Identify a hydraulic joint from its command and angle alone.

    Args:
        rig: nominal values and ranges; one joint.
        recordings: fitted together.
        holdout: recordings that are only compared with.
        starts: of the fits of step two and polish, the present values and random ones; None for what
            `two_step.yaml` says.
        polish: whether all parameters are fitted together at the end, which the thesis does not do.
        seed: of the random starts.
        progress: told what is done.

    Raises:
        InputError: a rig of several joints or without these hydraulics, a recording without command or angle.
    """
    joint = only_joint(rig)
    data = two_step_data()["search"]
    rng = np.random.default_rng(seed)
    followed = [
        one for recording in (*recordings, *holdout) for one in experiments_of(rig, recording, ("position",))
    ]
    held = len(holdout)
    noise = float(np.degrees(np.sqrt(np.mean([e.channels[0].noise ** 2 for e in followed]))))
    stages: list[Stage] = []

    def judged(
        name: str, model: Rig, fit: Fit | None = None, searched: ParameterSet | None = None, made: int = 0
    ) -> Stage:
        angles = [np.degrees(e.simulate(model.records()).signals.reading) for e in followed]
        misses = [np.degrees(e.channels[0].measured) - a for e, a in zip(followed, angles, strict=True)]
        split = len(followed) - held
        ends: tuple[str, ...] = ()
        values: dict[str, float] = {}
        if fit is not None and searched is not None:
            values = searched.values(fit.unit)
            near = np.minimum(fit.unit, 1.0 - fit.unit) < 1e-3
            ends = tuple(path for path, at in zip(searched.paths, near, strict=True) if at)
        stage = Stage(
            name,
            model,
            values,
            ends,
            _rms(misses[:split]),
            _rms(misses[split:]) if held else None,
            tuple(angles),
            made,
        )
        stages.append(stage)
        return stage

    def fitted(name: str, model: Rig, paths: Sequence[str], also: Sequence[Rig] = ()) -> Stage:
        progress(name)
        count = int(data["starts"]["value"]) if starts is None else starts
        parameters = ParameterSet(model, free_parameters(model, paths))
        problem = Problem(parameters, followed[: len(followed) - held])
        own = [parameters.unit(), *(_unit_of(parameters, other) for other in also)]
        if name == STAGES[1]:
            own, count = [_searched(problem, own[0], int(data["evaluations_with_gain"]["value"]), rng)], 1
        random = rng.uniform(size=(max(count - len(own), 0), len(parameters)))
        fit = multi_start(
            problem,
            [*own, *random],
            most_steps=int(data["steps"]["value"]),
            progress=lambda number, best: progress(
                f"{name}: start {number + 1} of {max(count, len(own))}, {best.over_noise:.3g} times the noise"
            ),
        )
        return judged(name, parameters.with_rig_values(fit.unit), fit, parameters, problem.evaluations)

    found = TwoStep(joint, stages, noise, tuple(followed), held)
    try:
        judged(STAGES[0], rig)
        gain = gain_rig(rig, joint)
        mechanical = mechanical_ranges(rig, joint)
        one = fitted(STAGES[1], with_ranges(gain, mechanical), [gain_path(joint), *mechanical])
        mechanics = {path: one.values[path] for path in mechanical}
        standing = with_ranges(rig, mechanical).with_values(mechanics)
        judged(STAGES[2], standing)
        hydraulic = hydraulic_ranges(rig, joint)
        two = fitted(STAGES[3], with_ranges(standing, hydraulic), list(hydraulic))
        if polish:
            everything = all_ranges(rig, joint)
            fitted(STAGES[4], with_ranges(two.rig, everything), list(everything), also=[rig])
    except KeyboardInterrupt:
        if not stages:
            raise
        return TwoStep(joint, stages, noise, tuple(followed), held, interrupted=True)
    return found


def _searched(problem: Problem, unit: np.ndarray, budget: int, rng: np.random.Generator) -> np.ndarray:
    """Best place that CMA-ES finds; Ctrl-C ends the whole identification, not the search alone."""
    ends = np.zeros(len(unit)), np.ones(len(unit))
    found = search("cma", RigObjective(problem), *ends, budget, rng, first=unit[None])
    if found.interrupted:
        raise KeyboardInterrupt
    return found.point


def _unit_of(parameters: ParameterSet, rig: Rig) -> np.ndarray:
    """Another rig's values as a place in the cube."""
    return parameters.unit({path: rig.value(path) for path in parameters.paths})


def _rms(parts: Sequence[np.ndarray]) -> float:
    """Root mean square of all finite values; infinite where a model diverged throughout."""
    values = np.concatenate(list(parts))
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if finite.size else float("inf")
