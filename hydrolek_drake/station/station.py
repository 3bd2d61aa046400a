"""A rig as a Drake Diagram: every stage a system, wired from command to sensor."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort, System
from pydrake.systems.primitives import LogVectorOutput, VectorLogSink

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import cylinder
from hydrolek_drake.physics.law import any_gives, law_of
from hydrolek_drake.physics.lines import hose
from hydrolek_drake.physics.probes import RAMP
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rollout import check_driven
from hydrolek_drake.station.mechanics import Add, Mechanics, wire_mechanics
from hydrolek_drake.station.plant import Payload, RigPlant, add_plant
from hydrolek_drake.station.step_sizes import StepSizes, sizes_for
from hydrolek_drake.systems.actuator import Actuator
from hydrolek_drake.systems.command_ramp import CommandRamp
from hydrolek_drake.systems.electric_motor import ElectricMotor
from hydrolek_drake.systems.four_way_valve import FourWayValve
from hydrolek_drake.systems.long_lines import LongLines
from hydrolek_drake.systems.operator_computer import FieldPoint, OperatorComputer
from hydrolek_drake.systems.potentiometer import Potentiometer
from hydrolek_drake.systems.proportional_amplifier import ProportionalAmplifier
from hydrolek_drake.systems.recorded import Recorded
from hydrolek_drake.systems.short_law import Outside, ShortLaw
from hydrolek_drake.systems.solenoid_spool import SolenoidSpool
from hydrolek_drake.systems.supply import Supply
from hydrolek_drake.systems.transport_delay import TransportDelay


@dataclass(frozen=True)
class Station:
    """A built diagram and handles to what a user needs of it.

    Attributes:
        diagram: with input `command` (n, V) or `signal_commanded` (n, %), and `pressure_available` (1).
        rig: what it was built from.
        joints: the records.
        plant: the MultibodyPlant inside.
        payloads: bodies whose mass appears at a time.
        logs: name of a signal -> its log.
        systems: name -> system.
        sizes: the steps it runs at.
    """

    diagram: Diagram
    rig: Rig
    joints: np.ndarray
    plant: MultibodyPlant
    payloads: tuple[Payload, ...]
    logs: dict[str, VectorLogSink]
    systems: dict[str, System]
    sizes: StepSizes


def make_station(
    rig: Rig,
    *,
    sizes: StepSizes | None = None,
    command: System | None = None,
    operator: bool = False,
    noise: np.random.Generator | None = None,
    recorded: Recorded | None = None,
    visualize: Callable[[DiagramBuilder, RigPlant, Rig, np.ndarray], None] | None = None,
) -> Station:
    """Build the diagram of a rig.

    Args:
        rig: the machine.
        sizes: step sizes; `sizes_for` the rig, logged every 10 ms, if not given.
        command: system whose first output are n voltages (or signals, with `operator`); one that has an input
            `position_measured` is a controller, and sees what the sensors measure. None leaves the diagram's input
            `command` (or `signal_commanded`) open.
        operator: whether commands are signals in percent that pass the operator computer and the field point.
        noise: source of sensor noise; None for ideal sensors.
        recorded: what was recorded, where the rig is driven by it.
        visualize: called with builder, plant, scene graph, rig and records before the diagram is built.

    Raises:
        InputError: electric and hydraulic joints in one rig, no calibration where `operator` asks for it, or a rig that
            is driven by recorded signals without them.
    """
    sizes = sizes or replace(sizes_for(rig), log_period=StepSizes.log_period)
    joints = rig.records()
    check_driven(joints, recorded is not None)
    builder = DiagramBuilder()
    body = add_plant(builder, rig, joints, sizes.plant_step)
    systems: dict[str, System] = {}

    def add(system: Any) -> Any:
        builder.AddSystem(system)
        systems[system.get_name()] = system
        return system

    delay = add(TransportDelay(joints, sizes.step))
    _wire_command(builder, add, joints, delay, command, operator)
    parts = wire_mechanics(builder, add, rig, joints, body, sizes)
    electric = cylinder.electric(joints)
    if electric.all():
        motor = add(ElectricMotor(joints))
        builder.Connect(_behind_the_ramp(builder, add, joints, sizes, delay.voltage), motor.voltage)
        builder.Connect(motor.force, parts.linkage.force)
        if motor.follows:
            builder.Connect(parts.linkage.rod_motion, motor.motion)
    elif electric.any():
        raise InputError(f"rig {rig.name}: electric and hydraulic joints cannot share one rig")
    else:
        _wire_hydraulics(builder, add, rig, joints, sizes, delay, parts, recorded)
    sensor = add(Potentiometer(joints, sizes.step, noise))
    builder.Connect(parts.sensed, sensor.motion)
    if command is not None and command.num_input_ports() > 0:
        builder.Connect(sensor.measured, command.GetInputPort("position_measured"))
    if any(law_of(joints[i : i + 1]) is not None for i in range(len(joints))):
        _wire_law(builder, add(ShortLaw(joints)), systems)
    logs = _add_logs(builder, systems, sizes.log_period)
    for port in (sensor.measured, sensor.voltage):
        builder.ExportOutput(port, port.get_name())
    builder.ExportOutput(parts.linkage.joint_motion, "joint_motion_true")
    if visualize is not None:
        visualize(builder, body, rig, joints)
    diagram = builder.Build()
    diagram.set_name(rig.name)
    return Station(diagram, rig, joints, body.plant, body.payloads, logs, systems, sizes)


def _behind_the_ramp(
    builder: DiagramBuilder, add: Add, joints: np.ndarray, sizes: StepSizes, voltage: OutputPort
) -> OutputPort:
    """The voltage itself where no joint has a ramp."""
    if not np.any(joints["command"]["ramp"] > 0.0) and not any_gives(joints, RAMP):
        return voltage
    ramp = add(CommandRamp(joints, sizes.step))
    builder.Connect(voltage, ramp.voltage)
    return ramp.ramped


def _wire_command(
    builder: DiagramBuilder,
    add: Add,
    joints: np.ndarray,
    delay: TransportDelay,
    command: System | None,
    operator: bool,
) -> None:
    entry = delay.command
    name = "command"
    if operator:
        computer, field_point = add(OperatorComputer(joints)), add(FieldPoint(joints))
        builder.Connect(computer.channels, field_point.channels)
        builder.Connect(field_point.command, delay.command)
        entry, name = computer.signal, "signal_commanded"
    if command is None:
        builder.ExportInput(entry, name)
    else:
        add(command)
        builder.Connect(command.get_output_port(0), entry)


def _wire_hydraulics(
    builder: DiagramBuilder,
    add: Add,
    rig: Rig,
    joints: np.ndarray,
    sizes: StepSizes,
    delay: TransportDelay,
    parts: Mechanics,
    recorded: Recorded | None,
) -> None:
    ahead = sizes.step if sizes.integrator == "symplectic_euler" and sizes.plant_step == 0.0 else 0.0
    amplifier = add(ProportionalAmplifier(joints, sizes.step))
    spool = add(SolenoidSpool(joints, sizes.step, round(rig.value("integration.spool_steps")), recorded))
    valve, supply, actuator = (
        add(FourWayValve(joints)),
        add(Supply(joints, sizes.step, recorded)),
        add(Actuator(joints, ahead, recorded)),
    )
    builder.Connect(_behind_the_ramp(builder, add, joints, sizes, delay.arriving), amplifier.voltage)
    builder.Connect(amplifier.current, spool.current)
    builder.Connect(spool.position, valve.spool)
    ports, fed = actuator.pressure, valve.flow
    if np.any(joints["hose"]["variant"] == hose.LONG_LINE):
        lines = add(LongLines(joints))
        builder.Connect(actuator.pressure, lines.pressure_in)
        builder.Connect(valve.flow, lines.flow_in)
        ports, fed = lines.pressure, lines.flow
    builder.Connect(ports, valve.pressure)
    builder.Connect(supply.pressure, valve.supply)
    builder.Connect(valve.flow, supply.flow)
    builder.Connect(fed, actuator.flow)
    if spool.feels_oil:
        builder.Connect(ports, spool.pressure)
        builder.Connect(supply.pressure, spool.supply)
    builder.Connect(parts.linkage.rod_motion, actuator.motion)
    builder.Connect(actuator.force, parts.linkage.force)
    builder.ExportInput(supply.available, "pressure_available")
    builder.ExportOutput(actuator.pressure, "pressure_measured")


def _wire_law(builder: DiagramBuilder, law: ShortLaw, systems: dict[str, System]) -> None:
    """Let a law see the machine, and every stage feel it."""
    seen = {
        law.motion: ("linkage", "joint_motion"),
        law.rod: ("linkage", "rod_motion"),
        law.pressure: ("actuator", "pressure"),
        law.spool: ("solenoid_spool", "spool_position"),
    }
    for port, (system, name) in seen.items():
        if system in systems and not (name == "rod_motion" and "actuator" not in systems):
            builder.Connect(systems[system].GetOutputPort(name), port)
    for system in systems.values():
        if isinstance(outside := getattr(system, "outside", None), Outside):
            builder.Connect(law.outside, outside.port)


def _add_logs(builder: DiagramBuilder, systems: dict[str, System], period: float) -> dict[str, VectorLogSink]:
    wanted = {
        "voltage": ("transport_delay", "voltage_delayed"),
        "reading": ("potentiometer", "position_ideal"),
        "measured": ("potentiometer", "position_measured"),
        "motion": ("linkage", "joint_motion"),
        "pressure": ("actuator", "pressure"),
        "spool": ("solenoid_spool", "spool_position"),
        "supply_pressure": ("supply", "supply_pressure"),
        "current": ("electric_motor", "motor_current"),
        "force": ("electric_motor" if "electric_motor" in systems else "actuator", "rod_force"),
    }
    logs = {}
    for name, (system, port) in wanted.items():
        if system in systems:
            logs[name] = LogVectorOutput(systems[system].GetOutputPort(port), builder, publish_period=period)
            logs[name].set_name(f"log_{name}")
    return logs
