"""A rig as a Drake Diagram: every stage a system, wired from command to sensor."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant, Propeller, PropellerInfo
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort, System
from pydrake.systems.primitives import Adder, Gain, LogVectorOutput, VectorLogSink

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import cylinder, linkage
from hydrolek_drake.physics.law import any_gives, law_of
from hydrolek_drake.physics.probes import RAMP
from hydrolek_drake.rigs import Rig
from hydrolek_drake.station.chain import read_chain, read_mounts
from hydrolek_drake.station.plant import Payload, RigPlant, add_plant
from hydrolek_drake.systems.actuator import Actuator
from hydrolek_drake.systems.command_ramp import CommandRamp
from hydrolek_drake.systems.electric_motor import ElectricMotor
from hydrolek_drake.systems.four_way_valve import FourWayValve
from hydrolek_drake.systems.linkage import Linkage
from hydrolek_drake.systems.load import Load
from hydrolek_drake.systems.operator_computer import FieldPoint, OperatorComputer
from hydrolek_drake.systems.play import Play
from hydrolek_drake.systems.potentiometer import Potentiometer
from hydrolek_drake.systems.proportional_amplifier import ProportionalAmplifier
from hydrolek_drake.systems.rocking_base import RockingBase
from hydrolek_drake.systems.short_law import Outside, ShortLaw
from hydrolek_drake.systems.solenoid_spool import SolenoidSpool
from hydrolek_drake.systems.supply import Supply
from hydrolek_drake.systems.transport_delay import TransportDelay

_Add = Callable[[Any], Any]  # adds a system to the diagram and returns it


INTEGRATORS = {
    "runge_kutta3": "runge_kutta3",
    "runge_kutta2": "runge_kutta2",
    "symplectic_euler": "semi_explicit_euler",
}
"""How a diagram may be integrated -> Drake's name for it. With the actuators' forces one step ahead, Drake's
semi-explicit Euler is symplectic in pressure and velocity too."""


@dataclass(frozen=True)
class StepSizes:
    """How finely a diagram runs.

    Attributes:
        step: of the spools, the transport delay and the integrator [s].
        plant_step: of a discrete MultibodyPlant [s], as contact needs it; 0 for a continuous plant, which is
            more accurate.
        log_period: how often signals are written [s].
        integrator: one of `INTEGRATORS`. "runge_kutta3" bears oil springs that nothing damps, such as a wrist whose
            valves are closed while the arm is thrown about; "runge_kutta2" asks for two evaluations a step instead
            of three and feeds such a spring's oscillation; "symplectic_euler" asks for one and is of first order.
        mount_forces: whether cylinders push at their mounting points, as in the thesis (4.2.4), or act by
            force times lever on their joint, which is the same by virtual work and takes less time.
    """

    step: float = 1e-3
    plant_step: float = 0.0
    log_period: float = 1e-2
    integrator: str = "runge_kutta3"
    mount_forces: bool = True

    def __post_init__(self) -> None:
        """Refuse an integrator that the actuators are not built for."""
        if self.integrator not in INTEGRATORS:
            raise InputError(f"integrator '{self.integrator}' is unknown; use {' or '.join(INTEGRATORS)}")


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
    visualize: Callable[[DiagramBuilder, RigPlant, Rig, np.ndarray], None] | None = None,
) -> Station:
    """Build the diagram of a rig.

    Args:
        rig: the machine.
        sizes: step sizes; the defaults run the whole machine several times faster than real time.
        command: system with one output of n voltages (or signals, with `operator`); None leaves the diagram's
            input `command` (or `signal_commanded`) open.
        operator: whether commands are signals in percent that pass the operator computer and the field point.
        noise: source of sensor noise; None for ideal sensors.
        visualize: called with builder, plant, scene graph, rig and records before the diagram is built.

    Raises:
        InputError: electric and hydraulic joints in one rig, or no calibration where `operator` asks for it.
    """
    sizes = sizes or StepSizes()
    joints = rig.records()
    builder = DiagramBuilder()
    body = add_plant(builder, rig, joints, sizes.plant_step)
    systems: dict[str, System] = {}

    def add(system: Any) -> Any:
        builder.AddSystem(system)
        systems[system.get_name()] = system
        return system

    delay = add(TransportDelay(joints, sizes.step))
    _wire_command(builder, add, joints, delay, command, operator)
    parts = _wire_mechanics(builder, add, rig, joints, body, sizes)
    electric = joints["cylinder"]["variant"] == cylinder.ELECTRIC_MOTOR
    if electric.all():
        motor = add(ElectricMotor(joints))
        builder.Connect(_behind_the_ramp(builder, add, joints, sizes, delay.voltage), motor.voltage)
        builder.Connect(motor.force, parts.linkage.force)
    elif electric.any():
        raise InputError(f"rig {rig.name}: electric and hydraulic joints cannot share one rig")
    else:
        _wire_hydraulics(builder, add, rig, joints, sizes, delay, parts)
    sensor = add(Potentiometer(joints, sizes.step, noise))
    builder.Connect(parts.sensed, sensor.motion)
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
    builder: DiagramBuilder, add: _Add, joints: np.ndarray, sizes: StepSizes, voltage: OutputPort
) -> OutputPort:
    """The voltage itself where no joint has a ramp."""
    if not np.any(joints["command"]["ramp"] > 0.0) and not any_gives(joints, RAMP):
        return voltage
    ramp = add(CommandRamp(joints, sizes.step))
    builder.Connect(voltage, ramp.voltage)
    return ramp.ramped


@dataclass(frozen=True)
class _Mechanics:
    linkage: Linkage
    sensed: OutputPort


def _wire_command(
    builder: DiagramBuilder,
    add: _Add,
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


def _wire_mechanics(
    builder: DiagramBuilder, add: _Add, rig: Rig, joints: np.ndarray, body: RigPlant, sizes: StepSizes
) -> _Mechanics:
    plant = body.plant
    chain = read_chain(plant, rig.joints)
    playing = joints["effects"]["linkage_backlash"]["gap_rad"] > 0.0
    rocking = joints["effects"]["base_compliance"]["stiffness_Nm_per_rad"] > 0.0
    is_cylinder = (joints["linkage"]["variant"] == linkage.TRIANGLE) & (
        joints["cylinder"]["variant"] == cylinder.CYLINDER
    )
    by_moment = playing | rocking | ~is_cylinder | (not sizes.mount_forces)
    mounts = [mount for mount in read_mounts(plant, rig.joints, joints, chain) if not by_moment[mount.joint]]
    has_side = bool(playing.any() or rocking.any())
    link = add(Linkage(joints, chain, mounts, plant.num_multibody_states(), has_side))
    load = add(Load(joints, chain, plant.num_velocities(), by_moment))
    builder.Connect(plant.get_state_output_port(), link.plant_state)
    if mounts:
        pushers = add(_pushers(link.ends))
        builder.Connect(link.mount_force, pushers.get_command_input_port())
        builder.Connect(plant.get_body_poses_output_port(), pushers.get_body_poses_input_port())
        builder.Connect(
            pushers.get_spatial_forces_output_port(), plant.get_applied_spatial_force_input_port()
        )
    builder.Connect(plant.get_state_output_port(), load.plant_state)
    builder.Connect(load.torque, plant.get_applied_generalized_force_input_port())
    side, sensed, moment = link.joint_motion, link.joint_motion, link.moment
    if playing.any():
        play = add(Play(joints))
        builder.Connect(link.joint_motion, play.motion)
        builder.Connect(link.moment, play.moment)
        side, moment = play.side, play.transmitted
    if rocking.any():
        base = add(RockingBase(joints))
        builder.Connect(link.moment, base.moment)
        builder.Connect(side, base.motion)
        side = base.relative
        sensed = side
        if playing.any():  # the sensor sits on the link, not on the actuator's side of the play
            less = builder.AddNamedSystem("tilt_reversed", Gain(-1.0, 2 * len(joints)))
            relative = builder.AddNamedSystem("link_less_tilt", Adder(2, 2 * len(joints)))
            builder.Connect(base.tilt, less.get_input_port())
            builder.Connect(link.joint_motion, relative.get_input_port(0))
            builder.Connect(less.get_output_port(), relative.get_input_port(1))
            sensed = relative.get_output_port()
    if has_side:
        builder.Connect(side, link.side)
    if by_moment.any():
        builder.Connect(moment, load.moment)
    return _Mechanics(link, sensed)


def _pushers(ends: list[tuple[BodyIndex, np.ndarray]]) -> Propeller:
    """Drake's own system that puts forces on bodies, here without any spin: three along the axes of each mount.

    Forces as Python objects would take longer than all else that is done in a step.
    """
    axes = [RotationMatrix.MakeFromOneVector(axis, axis_index=2) for axis in np.eye(3)]
    pushers = Propeller(
        [PropellerInfo(body, RigidTransform(axis, point)) for body, point in ends for axis in axes]
    )
    pushers.set_name("mounts")
    return pushers


def _wire_hydraulics(
    builder: DiagramBuilder,
    add: _Add,
    rig: Rig,
    joints: np.ndarray,
    sizes: StepSizes,
    delay: TransportDelay,
    parts: _Mechanics,
) -> None:
    ahead = sizes.step if sizes.integrator == "symplectic_euler" and sizes.plant_step == 0.0 else 0.0
    amplifier = add(ProportionalAmplifier(joints, sizes.step))
    spool = add(SolenoidSpool(joints, sizes.step, round(rig.value("integration.spool_steps"))))
    valve, supply, actuator = add(FourWayValve(joints)), add(Supply(joints)), add(Actuator(joints, ahead))
    builder.Connect(_behind_the_ramp(builder, add, joints, sizes, delay.arriving), amplifier.voltage)
    builder.Connect(amplifier.current, spool.current)
    builder.Connect(spool.position, valve.spool)
    builder.Connect(actuator.pressure, valve.pressure)
    builder.Connect(supply.pressure, valve.supply)
    builder.Connect(valve.flow, supply.flow)
    builder.Connect(valve.flow, actuator.flow)
    if spool.feels_oil:
        builder.Connect(actuator.pressure, spool.pressure)
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
        "force": ("electric_motor" if "electric_motor" in systems else "actuator", "rod_force"),
    }
    logs = {}
    for name, (system, port) in wanted.items():
        if system in systems:
            logs[name] = LogVectorOutput(systems[system].GetOutputPort(port), builder, publish_period=period)
            logs[name].set_name(f"log_{name}")
    return logs
