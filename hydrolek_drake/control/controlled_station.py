"""The full hydraulic machine with controllers in its loop, as one Drake Diagram."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import LogVectorOutput, MatrixGain, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from hydrolek_drake.control.controller import Controller
from hydrolek_drake.control.law import Array, ControlLaw
from hydrolek_drake.control.operator_path import through_operator_computer
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.station.simulation import initial_context
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import INTEGRATORS, StepSizes

_EARLY = 1e-9  # seconds by which set points come early, so that rounding never makes them a sample late
_PROGRESS_S = 0.5


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
        sizes: steps of the diagram; it is logged at the control samples, whatever they say.
        on_progress: called with the simulated time now and then.

    Returns:
        Signals at the control samples.

    Raises:
        InputError: a law for a joint that the rig does not move, or no column for a law.
    """
    joints = list(laws)
    wanted = np.asarray(set_points_deg, dtype=float)
    for joint in joints:
        if joint not in rig.joints:
            raise InputError(f"rig {rig.name} has no joint '{joint}'; choose {', '.join(rig.joints)}")
    if wanted.ndim != 2 or wanted.shape[1] != len(joints):
        raise InputError(
            f"set points have shape {wanted.shape}; {len(joints)} controllers need (n, {len(joints)})"
        )
    sizes = replace(
        sizes or StepSizes(integrator="symplectic_euler", mount_forces=False), log_period=sample_s
    )
    rig, signal_per_volt = through_operator_computer(rig)
    operator = signal_per_volt is not None
    station = make_station(rig, sizes=sizes, noise=noise, operator=operator)
    positions = np.array(station.joints["load"]["initial_position"], dtype=float)
    for joint, angle_deg in (initial_deg or {}).items():
        positions[rig.joints.index(joint)] = np.radians(angle_deg)
    rest = initial_context(station, positions)  # while the station is a diagram of its own
    places = [rig.joints.index(joint) for joint in joints]
    scatter = np.zeros((len(rig.joints), len(joints)))
    scatter[places, np.arange(len(joints))] = 1.0

    builder = DiagramBuilder()
    builder.AddSystem(station.diagram)
    controller = builder.AddSystem(Controller([laws[joint] for joint in joints], sample_s))
    signals = scatter if signal_per_volt is None else signal_per_volt[:, np.newaxis] * scatter
    spread = builder.AddNamedSystem("signal_of_voltage" if operator else "to_all_joints", MatrixGain(signals))
    gather = builder.AddNamedSystem("of_controlled_joints", MatrixGain(scatter.T.copy()))
    duration = len(wanted) * sample_s
    breaks = np.append(np.arange(len(wanted)) * sample_s - _EARLY, duration + 1.0)
    held = np.radians(np.vstack([wanted, wanted[-1:]])).T
    source = builder.AddNamedSystem(
        "set_points", TrajectorySource(PiecewisePolynomial.ZeroOrderHold(breaks, held))
    )
    lost = duration + 1.0 if supply_lost_at is None else supply_lost_at
    available = PiecewisePolynomial.ZeroOrderHold([-1.0, lost, duration + 2.0], np.array([[1.0, 0.0, 0.0]]))
    supply = builder.AddNamedSystem("supply_available", TrajectorySource(available))
    builder.Connect(source.get_output_port(), controller.set_point)
    builder.Connect(station.diagram.GetOutputPort("position_measured"), gather.get_input_port())
    builder.Connect(gather.get_output_port(), controller.measured)
    builder.Connect(controller.command, spread.get_input_port())
    entry = "signal_commanded" if operator else "command"
    builder.Connect(spread.get_output_port(), station.diagram.GetInputPort(entry))
    builder.Connect(supply.get_output_port(), station.diagram.GetInputPort("pressure_available"))
    logs = {
        name: LogVectorOutput(port, builder, publish_period=sample_s)
        for name, port in (("voltage", controller.command), ("output", controller.output))
    }
    diagram = builder.Build()
    diagram.set_name(f"{rig.name}_controlled")

    context = diagram.CreateDefaultContext()
    inner = station.diagram.GetMyMutableContextFromRoot(context)
    inner.SetContinuousState(rest.get_continuous_state_vector().CopyToVector())
    for group in range(rest.num_discrete_state_groups()):
        inner.SetDiscreteState(group, rest.get_discrete_state(group).get_value())
    simulator = Simulator(diagram, context)
    config = SimulatorConfig(
        integration_scheme=INTEGRATORS[sizes.integrator], max_step_size=sizes.step, use_error_control=False
    )
    ApplySimulatorConfig(config, simulator)
    simulator.Initialize()
    now = 0.0
    while now < duration - _EARLY:
        now = min(now + _PROGRESS_S, duration)
        simulator.AdvanceTo(now)
        if on_progress is not None:
            on_progress(now)
    rows = len(wanted)
    reading = station.logs["reading"].FindLog(context)
    angle = np.degrees(reading.data()[places, :rows].T)
    # a log at a sample is written before that sample's update shows: the next row holds what it gave
    held_rows = {name: log.FindLog(context).data()[:, 1 : rows + 1].T for name, log in logs.items()}
    rows = min(len(angle), *(len(values) for values in held_rows.values()))
    return MachineSignals(
        np.arange(rows) * sample_s,
        wanted[:rows],
        angle[:rows].copy(),
        held_rows["voltage"][:rows].copy(),
        held_rows["output"][:rows].copy(),
    )
