"""Joints of a rig under recorded commands on the Drake Diagram: the same machine as `driving`, wired of LeafSystems."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields

import numpy as np

from hydrolek_drake.replay.driving import Driven, Moved
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import Inputs
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.station.simulation import Run, command_source, initial_context, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import sizes_for
from hydrolek_drake.systems.recorded import Recorded


def moved_by_diagram(
    rig: Rig,
    driven: Sequence[Driven],
    times: np.ndarray,
    elsewhere: Mapping[str, float],
    recorded: Mapping[str, Inputs] | None = None,
    on_progress: Callable[[float, float], None] | None = None,
) -> dict[str, Moved]:
    """What driven joints do, from rest in balance, with the whole machine in one Diagram.

    A joint without a command gives way on its oil, also where a rollout of one joint holds it.

    Args:
        rig: the machine.
        driven: joints with their commands; what was commanded before the first of `times` counts as its last value.
        times: when signals are wanted [s]; the first is when the machine is switched on. # (k,)
        elsewhere: joint without a command -> reading where it rests, if that is known [rad or m].
        recorded: joint -> what was recorded in place of a part of it, from the first of `times` on.
        on_progress: told now and then how much is simulated, and of how much [s].
    """
    records = rig.records()
    begin = float(times[0])
    command_times = np.unique(np.concatenate([[begin], *(one.times[one.times >= begin] for one in driven)]))
    volts = np.tile(records["command"]["neutral"], (command_times.size, 1))
    for one in driven:
        held = np.searchsorted(one.times, command_times, side="right") - 1
        volts[held >= 0, rig.joints.index(one.joint)] = one.volts[held[held >= 0]]
    positions = records["load"]["initial_position"].copy()
    starts = {**elsewhere, **{one.joint: one.start for one in driven if one.start is not None}}
    for joint, reading in starts.items():
        place = rig.joints.index(joint)
        positions[place] = rest_state_at_reading(records[place : place + 1], reading)[4]
    driving = Recorded([recorded.get(joint) for joint in rig.joints]) if recorded else None
    command = command_source(command_times - begin, volts)
    station = make_station(rig, sizes=sizes_for(rig), command=command, recorded=driving)
    seconds = times - begin
    end = float(seconds[-1])
    try:
        done = run(
            station,
            end,
            context=initial_context(station, positions),
            on_progress=None if on_progress is None else lambda now: on_progress(now, end),
        )
    except RuntimeError as error:
        reason = f"broke down on the Diagram: {' '.join(str(error).split())[:120]}"
        return {one.joint: Moved(_nothing(times), reason) for one in driven}
    return {
        one.joint: Moved(_signals_of(done, rig.joints.index(one.joint), seconds, times), None)
        for one in driven
    }


def _signals_of(done: Run, place: int, seconds: np.ndarray, times: np.ndarray) -> Signals:
    """A joint's signals at the wanted moments, on straight lines between those of the run, which are a step apart."""

    def at(name: str, column: int) -> np.ndarray:
        if name not in done.signals:
            return np.zeros(seconds.size)
        return np.interp(seconds, done.time, done.signals[name][:, column])

    names = ("reading", "position", "velocity", "pressure_a", "pressure_b", "spool", "current")
    own = {name: at(name, place) for name in names}
    return Signals(times, **own, supply_pressure=at("supply_pressure", 0), force=at("force", place))


def _nothing(times: np.ndarray) -> Signals:
    return Signals(times, *(np.full(times.size, np.nan) for _ in fields(Signals)[1:]))
