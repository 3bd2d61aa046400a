"""What joints that move together do to each other, by the whole machine's Diagram.

Joints of one arm shake each other on their oil, faster than smoothed angles tell. Near the noise that matters: a
healthy machine would look as if something were missing. The Diagram with a fitted model's values tells it, since it
integrates all joints at once. Its motion and flows then stand as known inputs of each joint's own rollout, which
gives the same movement at these values (`neighbours`), and nearly so at values close by: the fit goes on with them and
asks the Diagram again.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.neighbours import Motion, probes_of
from hydrolek_drake.physics.valve import chamber_flows, openings
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rollout import rest_state_at_reading

SPACING_S = 1e-3
"""Of the samples of what the Diagram does [s]: a tenth of the period of the fastest shaking of an arm."""


def felt_together(rig: Rig, experiments: Sequence[Experiment]) -> list[Experiment]:
    """The same experiments, those of joints that move together with what the others do by the Diagram.

    Where the Diagram leaves all bounds they stay as they are.

    Args:
        rig: the machine with the values of a fitted model.
        experiments: of one or more recordings.
    """
    felt: list[Experiment] = []
    for group in recordings_of(experiments):
        felt += group if group[0].others is None else _simulated(rig, group)
    return felt


def recordings_of(experiments: Iterable[Experiment]) -> list[list[Experiment]]:
    """Experiments by the recording that they are of: those of one recording follow each other."""
    groups: list[list[Experiment]] = []
    for experiment in experiments:
        last = groups[-1] if groups else []
        if last and last[0].name == experiment.name and experiment.joint not in {e.joint for e in last}:
            last.append(experiment)
        else:
            groups.append([experiment])
    return groups


def _simulated(rig: Rig, group: Sequence[Experiment]) -> list[Experiment]:
    """The joints of one recording, beside each other in the Diagram."""
    # Drake takes a second to load, and joints mostly move alone
    from hydrolek_drake.station.simulation import command_source, initial_context, run
    from hydrolek_drake.station.station import make_station
    from hydrolek_drake.station.step_sizes import StepSizes

    records = rig.records()
    begin, end = min(float(e.time[0]) for e in group), max(float(e.time[-1]) for e in group)
    places = records["load"]["initial_position"].copy()
    volts = np.tile(records["command"]["neutral"], (group[0].command_times.size, 1))
    for e in group:
        volts[:, e.index] = e.command
        if e.start is not None:
            places[e.index] = rest_state_at_reading(records[e.index : e.index + 1], e.start)[4]
    station = make_station(
        rig,
        command=command_source(group[0].command_times, volts),
        sizes=StepSizes(log_period=SPACING_S),
    )
    try:
        done = run(station, end - begin, start=begin, context=initial_context(station, places))
    except RuntimeError:  # the plant refuses what is not a number
        return list(group)
    signals = done.signals
    told = ("position", "velocity", "pressure_a", "pressure_b", "spool", "supply_pressure", "reading")
    if not all(np.isfinite(signals[name]).all() for name in told):
        return list(group)
    motions: dict[str, Motion] = {}
    flows: dict[str, np.ndarray] = {}
    for i, joint in enumerate(rig.joints):
        position, velocity = signals["position"][:, i], signals["velocity"][:, i]
        motions[joint] = (position, velocity, np.gradient(velocity, SPACING_S))
        flows[joint] = _drawn(
            records[i],
            signals["spool"][:, i],
            signals["supply_pressure"][:, 0],
            signals["pressure_a"][:, i],
            signals["pressure_b"][:, i],
            done.time,
        )
    firsts = {e.joint: float(e.time[0]) - begin for e in group}
    probes = probes_of(rig, motions, flows, SPACING_S, firsts)
    felt = [replace(e, others=probes[e.joint]) for e in group]
    return [replace(e, others_error=_apart(e, records, done.time, signals)) for e in felt]


def _apart(
    experiment: Experiment, records: np.ndarray, time: np.ndarray, signals: dict[str, np.ndarray]
) -> np.ndarray:
    """By how much a joint's own rollout differs from the Diagram at the same values. # (channels, n)."""
    own = experiment.simulate(records).signals
    models = [channel.model for channel in experiment.channels]
    whole = [np.interp(experiment.time, time, signals[model][:, experiment.index]) for model in models]
    return np.array([getattr(own, model) for model in models]) - np.array(whole)


@njit(cache=True)
def _drawn(
    joint: Any,
    spool: np.ndarray,
    p_supply: np.ndarray,
    p_a: np.ndarray,
    p_b: np.ndarray,
    time: np.ndarray,
) -> np.ndarray:
    """What a joint draws from the supply [m^3/s]. # (n,)."""
    drawn = np.empty(spool.size)
    for n in range(spool.size):
        open_a, open_b = openings(spool[n], joint)
        drawn[n] = chamber_flows(open_a, open_b, p_supply[n], p_a[n], p_b[n], time[n], joint)[2]
    return drawn
