"""Inputs to a joint from outside the model, all zero otherwise.

Unknown ones, one a stage, with which a diagnosis asks where physics is missing and which a law gives (`law`);
what other joints do; and what was recorded, where that takes the place of a part of the model (`driven`).
"""

from typing import NamedTuple

import numpy as np

from hydrolek_drake.compiling import njit


class Probe(NamedTuple):
    """The inputs at one moment."""

    command: float  # added to the command [V]
    amplifier: float  # relative change of the coil currents
    valve: float  # relative change of the openings
    supply: float  # added to the supply pressure [Pa]
    cylinder: float  # force added at the rod [N]
    load: float  # moment added at the joint [N m]
    sensor: float  # added to the reading [rad or m]
    flow: float  # that other joints draw from the supply [m^3/s]
    capacity_a: float  # added to the oil's on side A: volume that it takes per pressure [m^3/Pa]
    capacity_b: float  # the same on side B
    back_a: float  # relative change of what the way from side A to the tank conducts
    back_b: float  # the same from side B
    ramp: float  # added to the time that the voltage takes for each volt [s/V]
    coil_time: float  # added to the time constant of the coils' currents [s]
    flow_force: (
        float  # added to the share of opening area times pressure drop with which oil closes the spool
    )


PROBES = Probe._fields
COMMAND, AMPLIFIER, VALVE, SUPPLY, CYLINDER, LOAD, SENSOR, FLOW = range(8)
CAPACITY_A, CAPACITY_B, BACK_A, BACK_B, RAMP, COIL_TIME, FLOW_FORCE = range(8, len(PROBES))
"""Their places."""

NO_PROBE = np.zeros((0, len(PROBES)))


@njit
def no_probe() -> Probe:
    """Nothing from outside."""
    return Probe(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@njit
def sample_at(time: float, begin: float, spacing: float, count: int) -> tuple[int, float]:
    """Place of the last sample before a time, and the share of the way to the next one that has gone by then."""
    place = min(max((time - begin) / spacing, 0.0), count - 1.0)
    i = min(int(place), count - 2)
    return i, place - i


@njit
def probe_at(time: float, begin: float, spacing: float, values: np.ndarray) -> Probe:
    """Probes at a time, on straight lines between samples of uniform spacing."""
    if len(values) == 0:
        return no_probe()
    i, f = sample_at(time, begin, spacing, len(values))
    a, b = values[i], values[i + 1]
    return Probe(
        a[0] + f * (b[0] - a[0]),
        a[1] + f * (b[1] - a[1]),
        a[2] + f * (b[2] - a[2]),
        a[3] + f * (b[3] - a[3]),
        a[4] + f * (b[4] - a[4]),
        a[5] + f * (b[5] - a[5]),
        a[6] + f * (b[6] - a[6]),
        a[7] + f * (b[7] - a[7]),
        a[8] + f * (b[8] - a[8]),
        a[9] + f * (b[9] - a[9]),
        a[10] + f * (b[10] - a[10]),
        a[11] + f * (b[11] - a[11]),
        a[12] + f * (b[12] - a[12]),
        a[13] + f * (b[13] - a[13]),
        a[14] + f * (b[14] - a[14]),
    )


@njit
def added(probe: Probe, at: float, value: float) -> Probe:
    """The same probes with a value added to the one at a place of `PROBES`."""
    return Probe(
        probe.command + (value if at == 0.0 else 0.0),
        probe.amplifier + (value if at == 1.0 else 0.0),
        probe.valve + (value if at == 2.0 else 0.0),
        probe.supply + (value if at == 3.0 else 0.0),
        probe.cylinder + (value if at == 4.0 else 0.0),
        probe.load + (value if at == 5.0 else 0.0),
        probe.sensor + (value if at == 6.0 else 0.0),
        probe.flow + (value if at == 7.0 else 0.0),
        probe.capacity_a + (value if at == 8.0 else 0.0),
        probe.capacity_b + (value if at == 9.0 else 0.0),
        probe.back_a + (value if at == 10.0 else 0.0),
        probe.back_b + (value if at == 11.0 else 0.0),
        probe.ramp + (value if at == 12.0 else 0.0),
        probe.coil_time + (value if at == 13.0 else 0.0),
        probe.flow_force + (value if at == 14.0 else 0.0),
    )
