"""Station, controllers and joysticks of both arms wired into one Diagram: the closed loop of `HydraulicArms`."""

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Adder, MatrixGain

from hydrolek_drake.control.controller import Controller
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.station.plant import RigPlant
from hydrolek_drake.station.station import Station
from hydrolek_drake.workcell.grip_contact import GripContact
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]


def add_contact(builder: DiagramBuilder, body: RigPlant, pipe: Pipe, table: Table | None) -> GripContact:
    """Add what the grippers may touch, and export its `grip_force`.

    It acts beside the cylinders, which act as moments here and leave the port for forces on bodies free.

    Args:
        builder: Of the station.
        body: The station's arms.
        pipe: What the grippers may touch.
        table: What a loose pipe stands on; None for one that does not give way.
    """
    contact = builder.AddSystem(GripContact(body.plant, pipe, table))
    builder.Connect(body.plant.get_state_output_port(), contact.plant_state)
    builder.Connect(contact.contact_force, body.plant.get_applied_spatial_force_input_port())
    builder.ExportOutput(contact.grip_force, "grip_force")
    return contact


def of_jaws(station: Station) -> Array:
    """Which joint each gripper's jaw is, shape (14, 2)."""
    spread = np.zeros((len(station.rig.joints), len(SIDES)))
    spread[[station.rig.joints.index(f"{side}_j7") for side in SIDES], np.arange(len(SIDES))] = 1.0
    return spread


def wired(
    station: Station,
    controller: Controller,
    joystick: Controller,
    force: Controller | None,
    signal_per_volt: Array,
) -> Diagram:
    """The machine in the loop of its controllers, as drawn at `HydraulicArms`.

    Args:
        station: Of both arms, with a `grip_force` where there is a controller of it.
        controller: Of all joints, by set points.
        joystick: Of all joints, by deflections.
        force: Of both grippers' forces, or None.
        signal_per_volt: Of the operator computer, in percent/V, shape (14,).
    """
    builder = DiagramBuilder()
    builder.AddSystem(station.diagram)
    builder.AddSystem(controller)
    builder.AddSystem(joystick)
    total = builder.AddNamedSystem("sum", Adder(2 if force is None else 3, len(station.rig.joints)))
    measured = station.diagram.GetOutputPort("position_measured")
    for index, system in enumerate((controller, joystick)):
        builder.Connect(measured, system.measured)
        builder.Connect(system.command, total.get_input_port(index))
    if force is not None:
        builder.AddSystem(force)
        jaws = builder.AddNamedSystem("to_jaws", MatrixGain(of_jaws(station)))
        builder.Connect(station.diagram.GetOutputPort("grip_force"), force.measured)
        builder.Connect(force.command, jaws.get_input_port())
        builder.Connect(jaws.get_output_port(), total.get_input_port(2))
        builder.ExportInput(force.set_point, "force_wanted")
    signal = builder.AddNamedSystem("signal_of_voltage", MatrixGain(np.diag(signal_per_volt)))
    builder.Connect(total.get_output_port(), signal.get_input_port())
    builder.Connect(signal.get_output_port(), station.diagram.GetInputPort("signal_commanded"))
    builder.ExportInput(controller.set_point, "set_point")
    builder.ExportInput(joystick.set_point, "deflection")
    builder.ExportInput(station.diagram.GetInputPort("pressure_available"), "pressure_available")
    diagram = builder.Build()
    diagram.set_name("hydraulic_arms")
    return diagram
