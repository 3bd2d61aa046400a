"""Controllers with their set points as what commands a station: one Drake system with the sensors as its input."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import (
    Adder,
    ConstantVectorSource,
    LogVectorOutput,
    MatrixGain,
    TrajectorySource,
    VectorLogSink,
)
from pydrake.trajectories import PiecewisePolynomial

from hydrolek_drake.control.controller import Controller
from hydrolek_drake.control.laws.law import Array, ControlLaw
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig

_EARLY = 1e-9  # seconds by which set points come early, so that rounding never makes them a sample late


@dataclass(frozen=True)
class LoopCommand:
    """A controller of some of a rig's joints with its set points.

    Attributes:
        system: with input `position_measured` (n, rad) and output `command` (n, V, or % where a signal stands for a
            volt); joints without a law stand at their neutral command.
        joints: that are controlled.
        sample_s: of the laws.
        set_points_deg: one row a control sample, one column a law; NaN withdraws a set point.
        logs: `voltage` and `output` of the controllers, at every control sample.
    """

    system: Diagram
    joints: tuple[str, ...]
    sample_s: float
    set_points_deg: NDArray[np.floating]
    logs: Mapping[str, VectorLogSink]

    def held(self, name: str, context: Context) -> NDArray[np.floating]:
        """A log's values, each held from its control sample on, shape (samples, laws).

        Args:
            name: of the log.
            context: of the diagram that holds `system`, after a run.
        """
        # a log at a sample is written before that sample's update shows: the next row holds what it gave
        values = self.logs[name].FindLog(context).data().T
        return np.array(values[1:] if len(values) > 1 else values)


def loop_command(
    rig: Rig,
    laws: Mapping[str, ControlLaw],
    set_points_deg: Array,
    sample_s: float,
    signal_per_volt: Array | None = None,
) -> LoopCommand:
    """Build the system.

    Args:
        rig: the machine.
        laws: by joint.
        set_points_deg: one row per control sample, one column per law; NaN withdraws a set point. The last row holds
            on.
        sample_s: of the laws.
        signal_per_volt: of `operator_path.through_operator_computer`; None for voltages.

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
    scatter = np.zeros((len(rig.joints), len(joints)))
    scatter[[rig.joints.index(joint) for joint in joints], np.arange(len(joints))] = 1.0
    builder = DiagramBuilder()
    controller = builder.AddSystem(Controller([laws[joint] for joint in joints], sample_s))
    breaks = np.append(np.arange(len(wanted)) * sample_s - _EARLY, len(wanted) * sample_s + 1.0)
    held = np.radians(np.vstack([wanted, wanted[-1:]])).T
    source = builder.AddNamedSystem(
        "set_points", TrajectorySource(PiecewisePolynomial.ZeroOrderHold(breaks, held))
    )
    gather = builder.AddNamedSystem("of_controlled_joints", MatrixGain(scatter.T.copy()))
    signals = scatter if signal_per_volt is None else signal_per_volt[:, np.newaxis] * scatter
    name = "to_all_joints" if signal_per_volt is None else "signal_of_voltage"
    spread = builder.AddNamedSystem(name, MatrixGain(signals))
    builder.Connect(source.get_output_port(), controller.set_point)
    builder.Connect(gather.get_output_port(), controller.measured)
    builder.Connect(controller.command, spread.get_input_port())
    builder.ExportInput(gather.get_input_port(), "position_measured")
    neutral = rig.records()["command"]["neutral"].astype(float)
    port = spread.get_output_port()
    if signal_per_volt is None and np.any(neutral != 0.0):
        total = builder.AddNamedSystem("about_neutral", Adder(2, len(neutral)))
        rest = builder.AddNamedSystem("neutral", ConstantVectorSource(neutral))
        builder.Connect(port, total.get_input_port(0))
        builder.Connect(rest.get_output_port(), total.get_input_port(1))
        port = total.get_output_port()
    builder.ExportOutput(port, "command")
    logs = {}
    for name, output in (("voltage", controller.command), ("output", controller.output)):
        logs[name] = LogVectorOutput(output, builder, publish_period=sample_s)
        logs[name].set_name(f"log_{name}")
    system = builder.Build()
    system.set_name("controllers")
    return LoopCommand(system, tuple(joints), sample_s, wanted, logs)
