"""From step tests to the SDP model: rates, dead times, laws, inverse dead-zone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.laws.inverse_dead_zone import InverseDeadZone, inverse_dead_zone
from hydrolek_drake.control.models.sdp_model import SdpModel
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.sdp.dead_time import dead_time_samples
from hydrolek_drake.identification.sdp.law_fit import LawFit, RateData, fit_exponential, fit_linear
from hydrolek_drake.identification.sdp.refined_iv import first_order_estimate, integrator_estimate
from hydrolek_drake.identification.sdp.step_test import StepTest, campaign_data


@dataclass(frozen=True)
class StepEstimate:
    """What one step test says.

    Attributes:
        level_V: voltage of the step.
        b: of (6.1) with a1 = -1 [deg per sample and V].
        b_error: standard error.
        rate_deg_per_s: b v / sample, as in figure 6.3.
        dead_time_s: NaN where the joint did not move.
        a1: estimated freely; -1 confirms the integrator. NaN where the joint did not move.
        moving: whether the joint moved.
    """

    level_V: float
    b: float
    b_error: float
    rate_deg_per_s: float
    dead_time_s: float
    a1: float
    moving: bool


@dataclass(frozen=True)
class SdpIdentification:
    """An SDP model and what it came from.

    Attributes:
        joint: name.
        steps: in the order of voltage.
        exponential: alpha1 to alpha6 of (6.3).
        linear: alpha1 to alpha4, and beta1 to beta6, of (6.20).
        model: with the exponential law.
        linear_model: with the linear one.
        inverse: parameters of (6.4), (6.5) for the exponential law.
    """

    joint: str
    steps: tuple[StepEstimate, ...]
    exponential: LawFit
    linear: tuple[LawFit, LawFit]
    model: SdpModel
    linear_model: SdpModel
    inverse: InverseDeadZone


def identify_sdp(
    joint: str, tests: Sequence[StepTest], lower_deg: float, upper_deg: float, limit_V: float
) -> SdpIdentification:
    """Estimate everything from the tests that begin at rest, as section 6.1.1 does.

    Args:
        joint: name, for messages.
        tests: of one sampling interval.
        lower_deg: end of the joint's range.
        upper_deg: the other.
        limit_V: largest voltage of the machine.

    Raises:
        InputError: no test begins at rest, or too few move the joint.
    """
    plan = campaign_data()
    margin = float(plan["margin"]["value"])
    resting = [test for test in tests if test.before_V == 0.0]
    if not resting:
        raise InputError(f"{joint}: no step test begins at rest (0 V before the step)")
    sample = resting[0].sample
    longest = round(float(plan["longest_dead_time"]["value"]) / sample)
    cut = [test.away_from_ends(lower_deg, upper_deg, margin) for test in resting]
    steps = [_estimate(test, longest) for test in cut if len(test.voltage_V) > test.step + longest]
    steps.sort(key=lambda step: step.level_V)
    if not any(step.moving for step in steps):
        raise InputError(f"{joint}: no step moves the joint, so nothing can be identified")
    delay = round(float(np.nanmedian([step.dead_time_s for step in steps])) / sample)
    level = np.array([step.level_V for step in steps])
    rate = np.array([step.rate_deg_per_s for step in steps]) * sample
    own = np.array([step.b_error for step in steps]) * np.abs(level)
    data = RateData(
        level,
        np.where([step.moving for step in steps], rate, 0.0),
        np.hypot(own, float(plan["law_error"]["value"]) * np.abs(rate)),
        np.array([step.moving for step in steps]),
    )
    exponential, linear = fit_exponential(data), fit_linear(data)
    model = SdpModel(joint, exponential.values, None, sample, delay, lower_deg, upper_deg)
    return SdpIdentification(
        joint=joint,
        steps=tuple(steps),
        exponential=exponential,
        linear=linear,
        model=model,
        linear_model=SdpModel(
            f"{joint}_linear", linear[0].values, linear[1].values, sample, delay, lower_deg, upper_deg
        ),
        inverse=inverse_dead_zone(model, limit_V),
    )


def _estimate(test: StepTest, longest: int) -> StepEstimate:
    """Dead time from the beginning of the motion, and with it the mean rate over the range."""
    plan = campaign_data()
    start = float(np.median(test.angle_deg[: test.step]))
    moved = np.flatnonzero(np.abs(test.angle_deg[test.step :] - start) > float(plan["early_motion"]["value"]))
    early = test.step + int(moved[0]) if moved.size else len(test.angle_deg)
    delay = dead_time_samples(test.angle_deg[:early], test.voltage_V[:early], min(longest, early - test.step))
    whole = max(round(delay), 0)
    found = integrator_estimate(test.angle_deg, test.voltage_V, whole)
    rate = found.b * test.level_V / test.sample
    error = found.b_error * abs(test.level_V) / test.sample
    moving = (
        abs(rate) > max(float(plan["still"]["value"]) * error, float(plan["slowest"]["value"]))
        and rate * test.level_V > 0.0
    )
    free = first_order_estimate(test.angle_deg, test.voltage_V, whole).a1 if moving else np.nan
    return StepEstimate(
        level_V=test.level_V,
        b=found.b,
        b_error=found.b_error,
        rate_deg_per_s=rate,
        dead_time_s=delay * test.sample if moving else np.nan,
        a1=free,
        moving=moving,
    )
