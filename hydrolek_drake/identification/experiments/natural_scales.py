"""The natural scales of a rig's joint, from its nominal numbers and from what was recorded."""

import math
from collections.abc import Sequence

import numpy as np

from hydrolek_drake.effects.scales import Scales, hydraulic_scales, motor_scales
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.one_point import drive_force, driven_inertia, full_flow, stroke_and_lever

HALF = 0.5
"""Half of the supply pressure falls over the inlet edge of a valve that moves its largest load."""

PLACES = 33
"""At so many places of what was recorded the actuator's stroke is looked at."""


def natural_scales(rig: Rig, joint: str, experiments: Sequence[Experiment]) -> Scales:
    """Scales of one joint; see `effects.scales.Scales`.

    Args:
        rig: the machine with its nominal numbers.
        joint: the joint's name.
        experiments: recordings of it, with the position as first channel.
    """
    own = [experiment for experiment in experiments if experiment.joint == joint]
    measured = [experiment.channels[0].measured for experiment in own]
    low = min(float(np.nanmin(values)) for values in measured)
    high = max(float(np.nanmax(values)) for values in measured)
    travel = max(high - low, 10.0 * max(experiment.channels[0].noise for experiment in own))
    duration = max(float(np.ptp(experiment.time)) for experiment in own)
    record = rig.records()[rig.joints.index(joint)]
    if not rig.is_hydraulic(joint):
        force = abs(drive_force(float(record["command"]["limit"]), record))
        speed = max(_fastest(experiment) for experiment in own)
        return motor_scales(force, speed, driven_inertia(record), travel, duration)
    pressure = float(record["supply"]["pressure"])
    _, lever = stroke_and_lever(0.5 * (low + high), record)
    # a linkage may turn round within what was recorded
    places = [stroke_and_lever(at, record) for at in np.linspace(low, high, PLACES).tolist()]
    nearest = min(stroke for stroke, _ in places)
    levers = [abs(at) for _, at in places]
    return hydraulic_scales(
        record,
        full_flow(pressure, HALF * pressure, record),
        abs(lever),
        travel,
        duration,
        nearest,
        (min(levers), max(levers)),
    )


def _fastest(experiment: Experiment) -> float:
    """Largest speed over a twentieth of the recording, which noise does not reach [m/s or rad/s]."""
    time, position = experiment.time, experiment.channels[0].measured
    steps = max(time.size // 20, 1)
    moved = np.abs(position[steps:] - position[:-steps]) / (time[steps:] - time[:-steps])
    finite = moved[np.isfinite(moved)]
    return float(finite.max()) if finite.size and finite.max() > 0.0 else math.nan
