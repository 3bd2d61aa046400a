"""Closing the loop sample by sample without a Diagram: on an SDP model, or on a rig's compiled rollout."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.control.laws.law import ControlLaw
from hydrolek_drake.control.models.sdp_model import SdpModel
from hydrolek_drake.errors import InputError
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import PreparedJoint

_EPSILON = 1e-9


@dataclass(frozen=True)
class LoopSignals:
    """What a loop did, one row per plant sample.

    Attributes:
        time_s: shape (n,).
        set_point_deg: wanted angle.
        angle_deg: the joint's angle.
        voltage_V: held between control samples.
        output: the controller's, in the unit of its input element.
    """

    time_s: NDArray[np.floating]
    set_point_deg: NDArray[np.floating]
    angle_deg: NDArray[np.floating]
    voltage_V: NDArray[np.floating]
    output: NDArray[np.floating]


def loop_on_model(
    law: ControlLaw,
    model: SdpModel,
    set_points_deg: ArrayLike,
    sample_s: float,
    *,
    initial_deg: float = 0.0,
) -> LoopSignals:
    """Control an SDP model.

    Args:
        law: one joint's.
        model: its sample time must divide the law's.
        set_points_deg: one per control sample, shape (m,).
        sample_s: of the law.
        initial_deg: where the joint rests at first.

    Returns:
        Signals at the model's samples.

    Raises:
        InputError: sample times that do not fit.
    """
    wanted = np.asarray(set_points_deg, dtype=float)
    ratio = round(sample_s / model.sample_s)
    if ratio < 1 or abs(ratio * model.sample_s - sample_s) > _EPSILON:
        raise InputError(
            f"the control sample of {sample_s:g} s is no multiple of the model's {model.sample_s:g} s"
        )
    n = len(wanted) * ratio
    angles, voltages, outputs = np.empty(n), np.empty(n), np.empty(n)
    angle, voltage, output = initial_deg, 0.0, 0.0
    state = law.initial(initial_deg)
    for k in range(n):
        if k % ratio == 0:
            state, output, voltage = law.step(state, float(wanted[k // ratio]), angle)
        angles[k], voltages[k], outputs[k] = angle, voltage, output
        past = k + 1 - model.delay_samples
        angle = model.step(angle, voltages[past] if past >= 0 else 0.0)
    time = np.arange(n) * model.sample_s
    return LoopSignals(time, np.repeat(wanted, ratio), angles, voltages, outputs)


def loop_on_rollout(
    law: ControlLaw,
    joint: np.ndarray,
    set_points_deg: ArrayLike,
    sample_s: float,
    *,
    rows_per_sample: int,
    longest_step: float,
    initial_deg: float | None = None,
    noise: Callable[[float], float] | None = None,
) -> LoopSignals:
    """Control the full hydraulic model of one joint.

    Args:
        law: one joint's.
        joint: parameter record, shape (1,).
        set_points_deg: one per control sample, shape (m,).
        sample_s: of the law.
        rows_per_sample: how many rows of signals are kept per control sample.
        longest_step: of the rollout's integration [s].
        initial_deg: where the joint rests at first; None for the rig's own.
        noise: angle [deg] to reading [deg]; None for an ideal sensor.

    Returns:
        Signals; rows after a divergence are NaN.
    """
    wanted = np.asarray(set_points_deg, dtype=float)
    sample = noise or (lambda angle: angle)
    start = None if initial_deg is None else np.radians(initial_deg)
    chain = rest_state(joint, start)
    angle = float(np.degrees(chain[4]))
    n = len(wanted) * rows_per_sample
    angles, voltages, outputs = np.full(n, np.nan), np.full(n, np.nan), np.full(n, np.nan)
    delay = float(joint["command"]["delay"][0] + joint["effects"]["command_delay"]["delay_s"][0])
    neutral = float(joint["command"]["neutral"][0])
    keep = int(np.ceil(delay / sample_s)) + 2
    times: list[float] = [-delay - sample_s]
    commands: list[float] = [neutral]
    state = law.initial(angle)
    machine = PreparedJoint(joint, longest_step=longest_step)
    for k, wanted_now in enumerate(wanted):
        now = k * sample_s
        state, output, voltage = law.step(state, float(wanted_now), sample(angle))
        times.append(now)
        commands.append(neutral + voltage)
        rows = now + sample_s * np.arange(rows_per_sample + 1) / rows_per_sample
        outcome = machine.roll_out(np.array(times[-keep:]), np.array(commands[-keep:]), rows, state=chain)
        place = slice(k * rows_per_sample, (k + 1) * rows_per_sample)
        readings = np.degrees(outcome.signals.reading)
        angles[place], voltages[place], outputs[place] = readings[:-1], voltage, output
        if outcome.diverged is not None:
            break
        chain, angle = outcome.state, float(readings[-1])
    time = np.arange(n) * sample_s / rows_per_sample
    return LoopSignals(time, np.repeat(wanted, rows_per_sample), angles, voltages, outputs)
