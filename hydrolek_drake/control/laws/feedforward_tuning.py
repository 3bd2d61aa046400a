"""Numbers of the feedforward law: those that are tuned, and those that are chosen."""

from dataclasses import dataclass
from functools import cache
from typing import Any

from hydrolek_drake.yaml_files import package_yaml


@dataclass(frozen=True)
class FeedforwardTuning:
    """Free numbers of the law.

    Attributes:
        gain: rate per predicted error near the set point [1/s].
        landing_s: how long before the set point, at its saturation rate, a fast joint is to be stopped; the rest is
            moved after it has been seen where it stopped.
        braking: whole samples at the saturation rate that must be left for another one to be driven so.
        starting: how many times that a joint must have before it that is not yet driven at the saturation rate.
        correction: share of the reading's deviation that the angle's estimate takes up in a sample.
        learn_rate: share of the saturation rate's deviation that is learned in a sample.
        learn_edge: share of the dead-zone's deviation that is learned in a sample.
        learn_landing: share of a late stop that is learned as dead time.
        push: how fast the wanted rate grows while the joint stands although it should move; 1 covers the error in the
            time that it takes to see that it moves.
        slowest: least rate while the set point is not reached [deg/s].
        stop_within_deg: predicted error at which the valve closes.
        start_beyond_deg: mean error at which it opens again.
        reserve: share of the dead-zone by which the voltage at saturation is raised, so that a joint whose dead-zone
            has grown still saturates.
        crossing_V: how far the voltage may move in a sample within the dead-zone.
        opening_V: how much further the valve may open in a sample; closing is free.
        closed: share of the dead-zone at which the valve is held while it is seen where the joint stops.
    """

    gain: float
    landing_s: float
    braking: float
    starting: float
    correction: float
    learn_rate: float
    learn_edge: float
    learn_landing: float
    push: float
    slowest: float
    stop_within_deg: float
    start_beyond_deg: float
    reserve: float
    crossing_V: float
    opening_V: float
    closed: float


@cache
def tuning_data() -> dict[str, Any]:
    """Content of `feedforward.yaml`."""
    return package_yaml(__package__, "feedforward.yaml")


@cache
def tuning() -> FeedforwardTuning:
    """The tuning found on perturbed machines (docs/evidence/control.md)."""
    return FeedforwardTuning(**{key: float(item["value"]) for key, item in tuning_data()["tuning"].items()})


@cache
def limit(name: str) -> float:
    """One of the chosen numbers in `feedforward.yaml`."""
    return float(tuning_data()["limits"][name]["value"])
