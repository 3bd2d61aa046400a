"""How a concealed machine is driven: random voltages, or a controller that tries to hide what is wrong."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from hydrolek_drake.rigs import Rig
from hydrolek_drake.yaml_files import package_yaml

SAMPLE_S = 0.01


class Driving(NamedTuple):
    """Numbers of commands and controller; `_a` towards positive angles, `_b` towards negative ones.

    Attributes:
        start_deg: where a machine starts, at rest.
        low_deg: set points lie above.
        high_deg: set points lie below.
        shortest_s: a voltage is held at least so long, a set point three times as long.
        longest_s: a voltage is held at most so long.
        least_a: smallest voltage that is commanded, apart from none [V].
        least_b: as least_a, without its sign.
        most_a: largest voltage that is commanded [V].
        most_b: as most_a, without its sign.
        jump_a: voltage with which the controller steps over the dead-zone [V].
        jump_b: as jump_a, without its sign.
        limit_a: largest voltage of the controller [V].
        limit_b: as limit_a, without its sign.
        gain: of the controller [V/rad].
        tolerance: error that the controller leaves [rad].
    """

    start_deg: float
    low_deg: float
    high_deg: float
    shortest_s: float
    longest_s: float
    least_a: float
    least_b: float
    most_a: float
    most_b: float
    jump_a: float
    jump_b: float
    limit_a: float
    limit_b: float
    gain: float
    tolerance: float


class Played(NamedTuple):
    """What a machine did, without noise: applied voltage, reading [rad], pressures [Pa]. # (n,) each."""

    volts: np.ndarray
    reading: np.ndarray
    pressure_a: np.ndarray
    pressure_b: np.ndarray


def _numbers() -> dict[str, Any]:
    numbers: dict[str, Any] = package_yaml(__package__, "driving.yaml")
    return numbers


def bench_driving() -> Driving:
    """As the practice recordings of the bench were driven, which bench.md describes in words."""
    own = _numbers()["bench"]
    both: Mapping[str, float] = own["both_directions"]
    sides = {f"{name}_{side}": value for name, value in both.items() for side in ("a", "b")}
    return Driving(**{name: value for name, value in own.items() if name != "both_directions"}, **sides)


def arm_driving(rig: Rig) -> Driving:
    """As the operator computer drives an arm: voltages from dead-band to signal 100 of (4.2) and (4.3)."""
    own = _numbers()["arm"]
    joint = rig.joints[0]
    lower, upper = (math.degrees(rig.value(f"load.{name}")) for name in ("lower_stop", "upper_stop"))
    least_a, most_a, least_b, most_b = (rig.value(f"command.calibration_{name}") for name in "abcd")
    low, high = own["set_points"]
    return Driving(
        start_deg=math.degrees(rig.value("load.initial_position")),
        low_deg=lower + low * (upper - lower),
        high_deg=lower + high * (upper - lower),
        shortest_s=own["shortest_s"],
        longest_s=own["longest_s"],
        least_a=least_a,
        least_b=least_b,
        most_a=most_a,
        most_b=most_b,
        jump_a=least_a,
        jump_b=least_b,
        limit_a=most_a,
        limit_b=most_b,
        gain=own["gain"][rig.variant(joint, "cylinder")],
        tolerance=own["tolerance"],
    )


def random_series(driving: Driving, closed: bool, seconds: float, rng: np.random.Generator) -> np.ndarray:
    """Voltages [V], or for a controller set points [rad], one a sample; nothing moves in the first half second."""
    count = round(seconds / SAMPLE_S)
    levels: list[float] = [0.0] * 50
    while len(levels) < count:
        hold = int(rng.uniform(driving.shortest_s, driving.longest_s) / SAMPLE_S)
        if closed:
            levels += [math.radians(rng.uniform(driving.low_deg, driving.high_deg))] * (3 * hold)
        else:
            levels += [0.0 if rng.random() < 0.2 else _voltage(driving, float(rng.uniform(-1.0, 1.0)))] * hold
    series = np.array(levels[:count])
    if closed:
        series[:50] = math.radians(driving.start_deg)
    return series


def _voltage(driving: Driving, signal: float) -> float:
    """Voltage of a signal from -1 to 1, (4.2) and (4.3)."""
    if signal >= 0.0:
        return driving.least_a + signal * (driving.most_a - driving.least_a)
    return -driving.least_b + signal * (driving.most_b - driving.least_b)


def unhindered(driving: Driving) -> Driving:
    """The same, but nobody turns back before an end: for voltages that were applied once and are applied again."""
    return driving._replace(low_deg=-math.inf, high_deg=math.inf)


@njit
def controlled(error: float, driving: Any) -> float:
    """Voltage of a proportional controller that steps over the dead-zone [V]; `error` in rad."""
    if abs(error) <= driving.tolerance:
        return 0.0
    if error > 0.0:
        return min(driving.gain * error + driving.jump_a, driving.limit_a)
    return max(driving.gain * error - driving.jump_b, -driving.limit_b)


@njit
def turned_back(volts: float, reading: float, driving: Any) -> float:
    """A voltage that is about to be held, turned round if it would drive a joint near its end into the stop [V]."""
    outwards = volts > 0.0 if reading > math.radians(driving.high_deg) else volts < 0.0
    if math.radians(driving.low_deg) <= reading <= math.radians(driving.high_deg) or not outwards:
        return volts
    return -volts
