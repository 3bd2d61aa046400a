"""A rig's joint driven through a command: the compiled execution's front door."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from hydrolek_drake.compiled import read_only
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.driven import is_driven
from hydrolek_drake.physics.law import law_of
from hydrolek_drake.physics.probes import NO_PROBE
from hydrolek_drake.physics.records import EFFECT_RECORD, STAGES, as_usual, flat, position_of
from hydrolek_drake.rollout import kernel
from hydrolek_drake.rollout.rest import STATE_SIZE, rest_state, state_size

DIVIDED_BY_ZERO = "a parameter by which something is divided is zero"


@dataclass(frozen=True)
class Signals:
    """What one joint did, one row per requested time; SI units (rad or m, Pa, N, A).

    `current` is that of an electric motor as its sensor reads it, 0 of other joints.
    """

    time: np.ndarray
    reading: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    pressure_a: np.ndarray
    pressure_b: np.ndarray
    spool: np.ndarray
    supply_pressure: np.ndarray
    force: np.ndarray
    current: np.ndarray


@dataclass(frozen=True)
class Outcome:
    """Result of a rollout; a diverged one is a value with a reason, never an exception.

    Attributes:
        signals: rows after the divergence are NaN.
        diverged: None, or where and how it diverged.
        state: final state, to go on from: also what the sensor's play reads and how long the machine has been on.
    """

    signals: Signals
    diverged: str | None
    state: np.ndarray


def roll_out(
    joint: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    *,
    state: np.ndarray | None = None,
    longest_step: float,
    spool_steps: int = 1,
    probes: tuple[float, np.ndarray] | None = None,
    pull: tuple[float, np.ndarray] | None = None,
    law: np.ndarray | None = None,
) -> Outcome:
    """Drive one joint with a recorded command.

    Args:
        joint: parameter record, shape (1,), dtype `physics.records.JOINT`.
        command_times: [s], increasing, shape (m,).
        command_values: [V], each held until the next, neutral before the first has arrived, shape (m,).
        times: when signals are wanted [s], increasing, shape (n,).
        state: where to start; None for rest at the rig's initial position.
        longest_step: upper bound of the integration step [s].
        spool_steps: steps of the spool within one step of the rest.
        probes: inputs from outside the model, `probes.PROBES`: spacing of their samples [s], and the samples,
            shape (k, 15), the first at the first of `times`; None for none. What is recorded and drives the joint
            comes by them too (`driven.INPUTS`).
        pull: reading and pressures are pulled to what was measured, as in an observer: time constant [s], and
            `kernel.PULLED` at `times`, NaN where there is no value, shape (n, 3); None for a free rollout.
        law: how inputs from outside follow from the state, rows of `law.LAW`, shape (k,), besides the law that the
            joint's record holds; None for none.

    Raises:
        InputError: times that do not rise, not as many command values as command times, or a joint that a recording
            drives without one.
    """
    prepared = PreparedJoint(joint, longest_step=longest_step, spool_steps=spool_steps, law=law)
    return prepared.roll_out(command_times, command_values, times, state=state, probes=probes, pull=pull)


class PreparedJoint:
    """A joint's record, checked and brought into the form of the compiled loop once: for many short rollouts.

    A controller gives a command every few steps of the integration, so that what is the same for all of them would
    take longer than they do.
    """

    def __init__(
        self,
        joint: np.ndarray,
        *,
        longest_step: float,
        spool_steps: int = 1,
        law: np.ndarray | None = None,
    ) -> None:
        """Prepare.

        Args:
            joint: as of `roll_out`, and so are the others.
            longest_step: upper bound of the integration step [s].
            spool_steps: steps of the spool within one step of the rest.
            law: how inputs from outside follow from the state.
        """
        self._joint, self._usual = joint, as_usual(joint)
        self._longest_step, self._spool_steps = longest_step, spool_steps
        self._law = with_own(law, joint)
        self._missing = missing_number(joint)
        self._driven = is_driven(joint)

    def roll_out(
        self,
        command_times: np.ndarray,
        command_values: np.ndarray,
        times: np.ndarray,
        *,
        state: np.ndarray | None = None,
        probes: tuple[float, np.ndarray] | None = None,
        pull: tuple[float, np.ndarray] | None = None,
    ) -> Outcome:
        """As `roll_out`, which tells what the arguments are.

        Raises:
            InputError: as of `roll_out`.
        """
        check_times(command_times, command_values, times)
        if self._driven:
            check_driven(self._joint, probes is not None)
        out = np.full((len(times), len(kernel.SIGNALS)), np.nan)
        times = read_only(times)
        start = np.full(state_size(self._joint), np.nan) if state is None else state.copy()
        probe_spacing, probe_values = probes or (1.0, NO_PROBE)
        changes = np.ones(len(command_values), dtype=bool)  # what only repeats the command says nothing
        np.not_equal(command_values[1:], command_values[:-1], out=changes[1:])
        pull_time, measured = pull or (0.0, kernel.NOT_PULLED)
        diverged = self._missing
        if diverged is None:
            try:
                start = rest_state(self._joint) if state is None else start
                rows = kernel.integrate(
                    self._usual,
                    start,
                    read_only(command_times[changes]),
                    read_only(command_values[changes]),
                    times,
                    self._longest_step,
                    self._spool_steps,
                    probe_spacing,
                    read_only(probe_values),
                    pull_time,
                    read_only(measured),
                    self._law,
                    start[STATE_SIZE:] if len(start) > STATE_SIZE else None,
                    out,
                )
                if rows < len(times):
                    diverged = why_diverged(self._joint, float(times[rows]))
                    if diverged == DIVIDED_BY_ZERO:
                        out[:] = np.nan
            except ZeroDivisionError:
                out[:] = np.nan
                diverged = DIVIDED_BY_ZERO
        return Outcome(Signals(times, *out.T), diverged, start)


def with_own(law: np.ndarray | None, joint: np.ndarray) -> np.ndarray | None:
    """A law and that of the joint's record."""
    own = law_of(joint)
    if law is None or own is None:
        return own if law is None else law
    return np.concatenate([own, law])


def check_driven(joints: np.ndarray, recorded: bool) -> None:
    """Refuse to roll out a joint that a recording drives where there is none.

    Raises:
        InputError: it is driven, and nothing recorded is given.
    """
    if not recorded and is_driven(joints):
        raise InputError(
            "the rig is driven by recorded signals, which there are none of here; take 'driven_by' out of its "
            "'recording' section"
        )


def check_times(command_times: np.ndarray, command_values: np.ndarray, times: np.ndarray) -> None:
    """Refuse what no rollout can be driven with.

    Raises:
        InputError: times that do not rise, or not as many command values as command times.
    """
    if len(command_times) == 0 or len(command_times) != len(command_values):
        raise InputError(
            f"rollout: {len(command_times)} command times but {len(command_values)} command values"
        )
    for name, series in (("command times", command_times), ("times", times)):
        if len(series) == 0 or not (series[1:] > series[:-1]).all():
            raise InputError(f"rollout: the {name} must rise from each to the next")


def why_diverged(joint: np.ndarray, time: float) -> str:
    """What is said of a rollout that left all bounds at a time [s]."""
    vector = flat(joint)[0]
    divisors, _ = _used(tuple(vector[_VARIANTS]), divisors=True)
    return DIVIDED_BY_ZERO if np.any(vector[divisors] == 0.0) else f"left all bounds at {time:.3f} s"


_VARIANTS = np.array([position_of(stage, "variant") for stage in STAGES])


def missing_number(joint: np.ndarray) -> str | None:
    """Which parameter of the chosen variants or of an effect is NaN, or None.

    NaN would not always show: a comparison with it is false, so that a valve with NaN overlap stays shut.
    """
    vector = flat(joint)[0]
    places, names = _used(tuple(vector[_VARIANTS]))
    missing = np.isnan(vector[places])
    if not missing.any():
        return None
    return f"{names[int(np.argmax(missing))]} is not a number (NaN)"


@cache
def _used(variants: tuple[float, ...], divisors: bool = False) -> tuple[np.ndarray, tuple[str, ...]]:
    """Places in a flat record, and names, of the parameters that count for these variants.

    Args:
        variants: of all stages.
        divisors: only of those by which something is divided, which must be positive.
    """
    used = {}
    for stage, code in zip(STAGES.values(), variants, strict=True):
        for parameter in stage.parameters(list(stage.variants)[int(code)]):
            if parameter.positive or not divisors:
                used[position_of(stage.name, parameter.name)] = f"{stage.name}.{parameter.name}"
    if divisors:
        return np.array(list(used)), tuple(used.values())
    for key in EFFECT_RECORD.names or ():
        for name in EFFECT_RECORD[key].names or ():
            used[position_of(key, name)] = f"effects.{key}.{name}"
    return np.array(list(used)), tuple(used.values())
