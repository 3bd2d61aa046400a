"""The full hydraulic machine with controllers in its loop, as one Drake Diagram."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.laws.law import Array, ControlLaw
from hydrolek_drake.control.laws.operator_path import through_operator_computer
from hydrolek_drake.control.loop_command import loop_command
from hydrolek_drake.rigs import Rig
from hydrolek_drake.station.simulation import initial_context, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes, sizes_for


@dataclass(frozen=True)
class MachineSignals:
    """What a controlled machine did, one row per logged time, one column per controlled joint.

    Attributes:
        time_s: shape (n,).
        set_point_deg: wanted angles.
        angle_deg: true angles as an ideal sensor reads them.
        voltage_V: commanded.
        output: of the controllers.
    """

    time_s: NDArray[np.floating]
    set_point_deg: NDArray[np.floating]
    angle_deg: NDArray[np.floating]
    voltage_V: NDArray[np.floating]
    output: NDArray[np.floating]


def run_controlled(
    rig: Rig,
    laws: Mapping[str, ControlLaw],
    set_points_deg: Array,
    sample_s: float,
    *,
    initial_deg: Mapping[str, float] | None = None,
    noise: np.random.Generator | None = None,
    supply_lost_at: float | None = None,
    sizes: StepSizes | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> MachineSignals:
    """Control joints of a machine; joints without a law have their valves closed.

    Voltages pass the operator computer and the field point where the rig has them, see `operator_path`.

    Args:
        rig: the machine.
        laws: by joint.
        set_points_deg: one row per control sample, one column per law; NaN withdraws a set point.
        sample_s: of the laws.
        initial_deg: where joints start; the others at the rig's initial position.
        noise: of the sensors; None for ideal ones.
        supply_lost_at: when the supply falls to tank pressure [s].
        sizes: steps of the diagram; `step_sizes.sizes_for` the rig if not given, forces as moments. It is logged at
            the control samples, whatever they say.
        on_progress: called with the simulated time now and then.

    Returns:
        Signals at the control samples.

    Raises:
        InputError: a law for a joint that the rig does not move, or no column for a law.
    """
    sizes = sizes or replace(sizes_for(rig), mount_forces=False)
    rig, signal_per_volt = through_operator_computer(rig)
    loop = loop_command(rig, laws, set_points_deg, sample_s, signal_per_volt)
    station = make_station(
        rig,
        sizes=replace(sizes, log_period=sample_s),
        command=loop.system,
        noise=noise,
        operator=signal_per_volt is not None,
    )
    positions = np.array(station.joints["load"]["initial_position"], dtype=float)
    for joint, angle_deg in (initial_deg or {}).items():
        positions[rig.joints.index(joint)] = np.radians(angle_deg)
    done = run(
        station,
        len(loop.set_points_deg) * sample_s,
        context=initial_context(station, positions),
        supply_lost_at=supply_lost_at,
        on_progress=on_progress,
    )
    places = [rig.joints.index(joint) for joint in loop.joints]
    angle = np.degrees(done.signals["reading"][:, places])
    voltage, output = (loop.held(name, done.final) for name in ("voltage", "output"))
    rows = min(len(loop.set_points_deg), len(angle), len(voltage))
    return MachineSignals(
        np.arange(rows) * sample_s,
        loop.set_points_deg[:rows],
        angle[:rows].copy(),
        voltage[:rows],
        output[:rows],
    )
