"""The output whose change is studied: a joint's reading under a command, split into segments."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.start import resting_position
from hydrolek_drake.identification.objective.norms import segment_edges
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import measured_position, position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import recorded_inputs, with_commands
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.run import Run

DURATION = 40.0
"""Seconds of the command that is used where no recording is given."""

DWELL = 0.5
"""Seconds for which it holds each level."""

SAMPLE = 0.01
"""Its sampling interval [s], section 4.3.1."""


@dataclass(frozen=True)
class Response:
    """Reading of a joint as a function of the place in the unit cube.

    Attributes:
        parameters: what is varied.
        index: the joint's place among the rig's.
        unit: of the reading, "deg" or "mm".
        factor: from SI to it.
        time: [s]. # (n,)
        command: [V]. # (n,)
        segments: equal parts of the time.
        recorded: what is recorded in place of a part of the model; None for nothing.
        start: position at which the joint rests at first [rad or m]; None for the rig's own.
    """

    parameters: ParameterSet
    index: int
    unit: str
    factor: float
    time: np.ndarray
    command: np.ndarray
    segments: int
    recorded: tuple[float, np.ndarray] | None = None
    start: float | None = None

    def __call__(self, unit: np.ndarray) -> np.ndarray:
        """Reading, NaN after a divergence. # (n,)."""
        return self.of_all([unit])[0]

    def of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        """The same at several places, rolled out in lanes."""
        rig = self.parameters.rig
        records = [self.parameters.records(unit)[self.index : self.index + 1] for unit in units]
        runs = [
            Run(
                record,
                self.time,
                self.command,
                self.time,
                longest_step=rig.value("integration.longest_step"),
                spool_steps=int(rig.value("integration.spool_steps")),
                probes=self.recorded,
                state=None if self.start is None else rest_state_at_reading(record, self.start),
            )
            for record in records
        ]
        return [self.factor * outcome.signals.reading for outcome in roll_out_lanes(runs)]

    def per_segment(self, change: np.ndarray) -> np.ndarray:
        """Root mean square of a change in each segment; NaN counts as none. # (..., n) -> (..., segments)."""
        edges = segment_edges(len(self.time), self.segments)
        squares = np.nan_to_num(change) ** 2
        parts = [squares[..., a:b].mean(axis=-1) for a, b in pairwise(edges)]
        return np.sqrt(np.stack(parts, axis=-1))


def response_of(
    rig: Rig,
    joint: str,
    parameters: ParameterSet,
    segments: int,
    recording: Recording | None,
    rng: np.random.Generator,
) -> Response:
    """The joint under a recorded command, or under random levels over its whole voltage range.

    Raises:
        InputError: no command in the recording, a constant one, or too many segments.
    """
    recorded = start = None
    if recording is None:
        time = np.arange(round(DURATION / SAMPLE)) * SAMPLE
        limit, neutral = (rig.value(f"joints.{joint}.command.{name}") for name in ("limit", "neutral"))
        held = round(DWELL / SAMPLE)
        levels = rng.uniform(-1.0, 1.0, -(-time.size // held))
        command = (
            neutral + np.repeat(limit * levels**3, held)[: time.size]
        )  # more small voltages than large ones
    else:
        key, recording = f"{joint}.command", with_commands(rig, recording)
        require(recording, [], complete=[key], units={key: "V"})
        time, command = (
            np.asarray(recording.time, dtype=float),
            np.asarray(recording.signal(key), dtype=float),
        )
        recorded = recorded_inputs(rig, joint, recording)
        if np.ptp(command) == 0.0 and rig.needs_command(joint):
            raise InputError(f"{recording.source}: {key} is constant, so no parameter shows")
        if rig.initial_position == "recording" and position_key(rig, joint) in recording.signals:
            position = np.asarray(measured_position(rig, joint, recording), dtype=float)
            start, _ = resting_position(position, command, noise_level(position))
    if not 1 <= segments <= time.size:
        raise InputError(f"--segments {segments}: choose 1 to {time.size}")
    sliding = rig.variant(joint, "load") == "sliding"
    return Response(
        parameters=parameters,
        index=rig.joints.index(joint),
        unit="mm" if sliding else "deg",
        factor=1e3 if sliding else float(np.degrees(1.0)),
        time=time,
        command=np.ascontiguousarray(command),
        segments=segments,
        recorded=recorded,
        start=start,
    )
