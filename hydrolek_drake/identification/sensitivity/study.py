"""A sensitivity study: one at a time, elementary effects, Sobol indices, and what cannot be told apart."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.identification.experiments.channel import faithful
from hydrolek_drake.identification.identifiability import Identifiability, identifiability
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.sensitivity.morris import ElementaryEffects, elementary_effects
from hydrolek_drake.identification.sensitivity.one_at_a_time import OneAtATime, one_at_a_time
from hydrolek_drake.identification.sensitivity.response import Response, response_of
from hydrolek_drake.identification.sensitivity.sobol import SobolIndices, sobol_of
from hydrolek_drake.identification.sensitivity.varied import Varied, varied_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import measured_position, position_key
from hydrolek_drake.rigs import Rig

DIFFERENCE = 1e-2
"""Step of the Jacobian's central differences, as a part of the range: above the jumps of a fraction of the
noise that come from an end stop being met in one integration step or in the next."""


@dataclass(frozen=True)
class SensitivityStudy:
    """Everything that was found about one joint.

    Attributes:
        joint: its name.
        varied: parameters and ranges.
        response: what was studied.
        one_at_a_time: outputs over each parameter's range.
        effects: global screening, per segment.
        known: from the Jacobian at the rig's own values, in units of the reading's noise.
        sobol: variance-based indices; None unless asked for.
    """

    joint: str
    varied: Varied
    response: Response
    one_at_a_time: OneAtATime
    effects: ElementaryEffects
    known: Identifiability
    sobol: SobolIndices | None = None

    @property
    def paths(self) -> tuple[str, ...]:
        """Of the parameters."""
        return tuple(free.path for free in self.varied.free)

    @property
    def ranking(self) -> np.ndarray:
        """Parameters by mu* over all segments, the one that matters most first. # (parameters,)."""
        return np.argsort(-np.sqrt((self.effects.mean_size**2).mean(axis=1)), kind="stable")


def study_sensitivity(
    rig: Rig,
    joint: str,
    rng: np.random.Generator,
    *,
    recording: Recording | None = None,
    paths: list[str] | None = None,
    spread: float = 0.2,
    segments: int = 8,
    trajectories: int = 10,
    sobol_points: int | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> SensitivityStudy:
    """Study a joint's reading.

    Args:
        rig: the machine.
        joint: its joint.
        rng: draws trajectories, and the command where no recording is given.
        recording: whose command drives the joint.
        paths: only these parameters; None for the whole chain.
        spread: part of its value by which a parameter without a range is varied.
        segments: equal parts of the time.
        trajectories: of the global screening.
        sobol_points: N of the Sobol indices, a power of two; None for none.
        say: told what is being done.

    Raises:
        InputError: no such joint or parameter, or a recording without a command.
    """
    varied = varied_parameters(rig, joint, spread, paths)
    parameters = ParameterSet(rig, varied.free)
    response = response_of(rig, joint, parameters, segments, recording, rng)
    count = len(varied.free)
    single = one_at_a_time(response, progress=lambda done: say(f"one at a time: {done} of {count}"))
    effects = elementary_effects(
        response.of_all,
        response.per_segment,
        count,
        trajectories,
        rng,
        lambda done: say(f"elementary effects: trajectory {done} of {trajectories}"),
    )
    say("Jacobian")
    jacobian = _jacobian(response) / _noise(rig, joint, response, recording)
    sobol = None
    if sobol_points is not None:
        cost = sobol_points * (count + 2)
        sobol = sobol_of(
            response.of_all,
            segments,
            count,
            sobol_points,
            rng,
            lambda done: say(f"Sobol indices: {done} of {cost}"),
        )
    return SensitivityStudy(
        joint, varied, response, single, effects, identifiability(parameters.paths, jacobian), sobol
    )


def _noise(rig: Rig, joint: str, response: Response, recording: Recording | None) -> float:
    """Of the reading, in its unit: the rig's, the recording's, or as little as any model leaves."""
    told = rig.value(f"joints.{joint}.sensor.noise")
    if not told and recording is not None and position_key(rig, joint) in recording.signals:
        told = noise_level(np.asarray(measured_position(rig, joint, recording), dtype=float))
    if told:
        return response.factor * told
    return max(faithful(response(response.parameters.unit())), np.finfo(float).tiny)


def _jacobian(response: Response) -> np.ndarray:
    nominal = np.clip(response.parameters.unit(), DIFFERENCE, 1.0 - DIFFERENCE)
    steps = DIFFERENCE * np.eye(len(nominal))
    found = np.array(response.of_all([*(nominal + steps), *(nominal - steps)]))
    up, down = np.split(found, 2)
    return np.nan_to_num((up - down).T / (2.0 * DIFFERENCE))
