"""Both arms with their hydraulics under controllers, as one Drake Diagram that is stepped a sample at a time."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context, Diagram, DiagramBuilder

from hydrolek_drake.control.catalogue import CONTROLLERS, JointSetting, build_law, joystick_law, rig_setting
from hydrolek_drake.control.comparison.bench import MACHINE_STEP_S
from hydrolek_drake.control.controller import Controller
from hydrolek_drake.control.laws.grip_force import grip_force_law
from hydrolek_drake.control.laws.operator_path import through_operator_computer
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.station.plant import RigPlant
from hydrolek_drake.station.simulation import initial_context, without_payloads_to_come
from hydrolek_drake.station.station import Station, make_station
from hydrolek_drake.station.step_sizes import StepSizes
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.wiring import add_contact, of_jaws, wired
from hydrolek_drake.teleop.link.signals import Signals
from hydrolek_drake.workcell.grip_contact import GripContact
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]

JOINTS = tuple(f"{side}_j{number}" for side in SIDES for number in range(1, 8))
_ROUNDING_DEG = 1e-3  # of angles as text
_SCHEME = "semi_explicit_euler"  # Drake's name for StepSizes' symplectic_euler


def joint_settings(rig: Rig) -> dict[str, JointSetting]:
    """What the controllers of all joints are built from, by simulated step tests.

    Raises:
        InputError: The rig is not the machine with both arms, or a joint does not move.
    """
    missing = [joint for joint in JOINTS if joint not in rig.joints]
    if missing or len(rig.joints) != len(JOINTS):
        raise InputError(
            f"rig {rig.name} is not both arms: it moves {len(rig.joints)} joints"
            + (f" and lacks {missing[0]}" if missing else "")
            + f"; {JOINTS[0]} to {JOINTS[-1]} are needed"
        )
    return {joint: rig_setting(rig, joint) for joint in JOINTS}


class HydraulicArms:
    """The full hydraulic machine with a controller and a joystick for each joint.

    ```
      set_point ---> +------------+
                     | controller | --+
                 +-> +------------+   |    +-----+     +-------------------+         +---------+
                 |                    +--> | sum | --> | signal_of_voltage | ------> | station | --+--> measured
                 +-> +------------+   |    +-----+     +-------------------+ signal  +---------+   |
     deflection ---> |  joystick  | --+                                                            |
                 |   +------------+                                                                |
                 +---------------------------------------------------------------------------------+
    ```
    Of the two, one has NaN as its input and gives 0 V; with both NaN all valves are closed (`control/laws/guard.py`).
    The voltages pass the operator computer's calibration, (4.2) and (4.3), and the channels of the field point, Table
    3.1, which are in the station (`control/laws/operator_path.py`).
    Joints 6 and 7 have no potentiometer on the machine; here the controllers read their simulated angles.

    Args:
        posture: Joints `right_j1` ... `left_j7` at first, in rad, shape (14,).
        rig: The machine; `hydrolek` if not given.
        controller: Name in the catalogue of controllers.
        seed: Of the sensors' noise.
        pipe: What the grippers may touch; None for nothing. It does not give way.
        table: What the pipe stands on; with one, it is loose and goes where a gripper takes it.
        visualize: Called while the station is built, see `make_station`.
        settings: From `joint_settings` of this rig, which takes a while; made if not given.

    Raises:
        InputError: Unknown controller, a rig that is not both arms, a posture beyond a stop.
    """

    def __init__(
        self,
        posture: ArrayLike,
        *,
        rig: Rig | None = None,
        controller: str = "feedforward",
        seed: int = 1,
        pipe: Pipe | None = None,
        table: Table | None = None,
        visualize: Callable[..., None] | None = None,
        settings: dict[str, JointSetting] | None = None,
    ) -> None:
        if controller not in CONTROLLERS:
            raise InputError(f"no controller '{controller}'; choose {', '.join(CONTROLLERS)}")
        self.rig = load_rig("hydrolek") if rig is None else rig
        start = np.asarray(posture, dtype=float)
        settings = joint_settings(self.rig) if settings is None else settings
        _refuse_beyond_stops(start, settings)
        sizes = StepSizes(
            step=MACHINE_STEP_S,
            log_period=sample_s(),
            integrator="symplectic_euler",
            mount_forces=False,
        )
        noise = np.random.default_rng(seed)
        self._contact: GripContact | None = None

        def add(builder: DiagramBuilder, body: RigPlant, rig: Rig, joints: np.ndarray) -> None:
            if pipe is not None:
                self._contact = add_contact(builder, body, pipe, table)
            if visualize is not None:
                visualize(builder, body, rig, joints)

        machine, signal_per_volt = through_operator_computer(self.rig)
        if signal_per_volt is None:
            raise InputError(f"rig {self.rig.name}: command.variant must be calibrated on every joint")
        self._station = make_station(machine, sizes=sizes, noise=noise, visualize=add, operator=True)
        rest = initial_context(self._station, start)  # while the station is a diagram of its own
        self._controller = Controller(
            [build_law(controller, settings[joint], noisy=True) for joint in self.rig.joints], sample_s()
        )
        self._joystick = Controller(
            [joystick_law(settings[joint], noisy=True) for joint in self.rig.joints],
            sample_s(),
            joystick=True,
        )
        self._force: Controller | None = None
        if self._contact is not None:
            jaws = [settings[f"{side}_j7"].scaling for side in SIDES]
            laws = [
                grip_force_law(scaling, closing=-1.0) for scaling in jaws
            ]  # a jaw opens in its positive direction
            self._force = Controller(laws, sample_s(), force=True)
        self._diagram = wired(self._station, self._controller, self._joystick, self._force, signal_per_volt)
        context = self._diagram.CreateDefaultContext()
        self._inner = self._station.diagram.GetMyMutableContextFromRoot(context)
        self._inner.SetContinuousState(rest.get_continuous_state_vector().CopyToVector())
        for group in range(rest.num_discrete_state_groups()):
            self._inner.SetDiscreteState(group, rest.get_discrete_state(group).get_value())
        self._to_pick_up = without_payloads_to_come(self._station, context)
        self._places = [self.rig.joints.index(joint) for joint in JOINTS]
        self._fix(context, None, None, None)
        self._diagram.GetInputPort("pressure_available").FixValue(context, [1.0])
        self._simulator = Simulator(self._diagram, context)
        config = SimulatorConfig(
            integration_scheme=_SCHEME, max_step_size=sizes.step, use_error_control=False
        )
        ApplySimulatorConfig(config, self._simulator)
        self._simulator.Initialize()
        self._samples = 0

    @property
    def diagram(self) -> Diagram:
        """The whole diagram."""
        return self._diagram

    @property
    def station(self) -> Station:
        """The machine in it."""
        return self._station

    def advance(
        self,
        set_point: ArrayLike | None = None,
        deflection: ArrayLike | None = None,
        grip: ArrayLike | None = None,
    ) -> Array:
        """Simulate one control sample.

        Args:
            set_point: Wanted joints in rad, shape (14,); None withdraws it.
            deflection: Of the joysticks in percent, shape (14,), instead; None lets them go. With neither, the
                valves close.
            grip: Wanted forces of the right and the left gripper in N, shape (2,), NaN for none; a jaw with one
                follows neither set point nor joystick. It needs a pipe, whose contact is what is measured.

        Returns:
            Measured joints in rad, shape (14,).
        """
        context = self._simulator.get_mutable_context()
        self._fix(context, set_point, deflection, grip)
        self._pick_up(context)
        self._samples += 1
        self._simulator.AdvanceTo(self._samples * sample_s())
        if self._samples % round(teleop_entries("plant")["forget_after"] / sample_s()) == 0:
            for log in self._station.logs.values():  # they would grow as long as the session lasts
                log.FindMutableLog(context).Clear()
        return self.measured()

    def _pick_up(self, context: Context) -> None:
        """Payloads whose time has come hang at the tool from this sample on."""
        for payload in [each for each in self._to_pick_up if each.time <= context.get_time()]:
            payload.body.SetMass(self._station.plant.GetMyMutableContextFromRoot(context), payload.mass)
            self._to_pick_up.remove(payload)

    def measured(self) -> Array:
        """Joints as their sensors read them, in rad, shape (14,)."""
        return self._of("position_measured")

    def position(self) -> Array:
        """Joints as they are, in rad, shape (14,)."""
        return self._of("joint_motion_true")

    def signals(self) -> Signals:
        """Everything that the console shows of the machine."""
        n = len(JOINTS)
        pressure = np.asarray(self._station.diagram.GetOutputPort("pressure_measured").Eval(self._inner))
        supply = self._station.systems["supply"]
        supply_pressure = supply.GetOutputPort("supply_pressure").Eval(
            supply.GetMyContextFromRoot(self._root)
        )
        voltage = np.zeros(n)
        for system in (self._controller, self._joystick):
            voltage += np.asarray(system.command.Eval(system.GetMyContextFromRoot(self._root)))
        if self._force is not None:
            jaws = np.asarray(self._force.command.Eval(self._force.GetMyContextFromRoot(self._root)))
            voltage += of_jaws(self._station) @ jaws
        return Signals(
            time=float(self._root.get_time()),
            voltage=voltage[self._places],
            pressure_a=pressure[:n][self._places],
            pressure_b=pressure[n:][self._places],
            potentiometer=self._of("potentiometer_voltage"),
            supply_pressure=float(supply_pressure[0]),
            grip=self.grip(),
            pipe_place=self.pipe_place(),
        )

    def grip(self) -> Array:
        """Force on the moving finger of the right and the left gripper in N, shape (2,)."""
        if self._contact is None:
            return np.zeros(len(SIDES))
        return np.array(self._contact.grip_force.Eval(self._contact.GetMyContextFromRoot(self._root)))

    def touch(self) -> Array:
        """Force of all fingers and the hand of the right and the left gripper on the pipe in N, shape (2,)."""
        if self._contact is None:
            return np.zeros(len(SIDES))
        sizes = self._contact.sizes(self._contact.GetMyContextFromRoot(self._root))
        return np.array(
            [sizes[[owner == side for owner, _ in self._contact.fingers]].sum() for side in SIDES]
        )

    def pipe_place(self) -> Array:
        """Middle of the pipe in m and its axis, world frame, shape (6,); NaN without a pipe."""
        if self._contact is None:
            return np.full(6, np.nan)
        context = self._contact.GetMyContextFromRoot(self._root)
        return np.array(self._contact.pipe_place.Eval(context))

    def holders(self) -> int:
        """How many hands hold a loose pipe."""
        if self._contact is None:
            return 0
        loose = self._contact.pipe_in(self._contact.GetMyContextFromRoot(self._root))
        return int(bool(loose.holder)) + int(loose.both is not None)

    def internal_force(self) -> Array:
        """What the left hand does to a pipe that both hold: force, moment, share of friction; shape (7,).

        See `GripContact`'s port of that name.
        """
        if self._contact is None:
            return np.zeros(7)
        context = self._contact.GetMyContextFromRoot(self._root)
        return np.array(self._contact.internal_force.Eval(context))

    @property
    def _root(self) -> Context:
        return self._simulator.get_context()

    def _of(self, port: str) -> Array:
        value = np.asarray(self._station.diagram.GetOutputPort(port).Eval(self._inner))
        return np.array(value[self._places])

    def _fix(
        self,
        context: object,
        set_point: ArrayLike | None,
        deflection: ArrayLike | None,
        grip: ArrayLike | None,
    ) -> None:
        forces = np.full(len(SIDES), np.nan) if grip is None else np.asarray(grip, dtype=float)
        if self._force is not None:
            self._diagram.GetInputPort("force_wanted").FixValue(context, forces)
        elif grip is not None:
            raise InputError("there is no pipe whose grip could be measured; build the arms with one")
        gripping = [f"{side}_j7" for side, force in zip(SIDES, forces, strict=True) if np.isfinite(force)]
        for name, values in (("set_point", set_point), ("deflection", deflection)):
            wanted = np.full(len(JOINTS), np.nan)
            if values is not None:
                wanted[self._places] = np.asarray(values, dtype=float)
                wanted[[self.rig.joints.index(joint) for joint in gripping]] = np.nan
            self._diagram.GetInputPort(name).FixValue(context, wanted)


def _refuse_beyond_stops(start: Array, settings: dict[str, JointSetting]) -> None:
    if start.shape != (len(JOINTS),) or not np.isfinite(start).all():
        raise InputError(f"posture has shape {start.shape}; give {len(JOINTS)} finite angles in rad")
    for joint, angle in zip(JOINTS, np.degrees(start), strict=True):
        low, high = settings[joint].model.lower_deg, settings[joint].model.upper_deg
        if not low - _ROUNDING_DEG <= angle <= high + _ROUNDING_DEG:
            raise InputError(f"posture: {joint} = {angle:.1f} deg lies outside {low:.1f} to {high:.1f} deg")
