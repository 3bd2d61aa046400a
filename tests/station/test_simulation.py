"""What the whole machine must do whatever its parameters: hold, mirror, lift, share its pump."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.runs.running import ScenarioRun, run_scenario
from hydrolek_drake.scenarios.scenario import load_scenario
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes

TURNED = {"j1", "j4", "j6"}  # these turn the other way on the left arm
LIFTING = ("j2", "j3", "j5")  # they carry the arm's weight, and fall when their angle falls


def all_joints(effect: str, value: str) -> dict[str, str]:
    return {f"joints.{joint}.effects.{effect}": value for joint in load_rig("hydrolek").joints}


def positions_after(done: ScenarioRun, time: float) -> np.ndarray:
    return done.run.signals["position"][done.run.time >= time - 1e-9]


def test_arms_hold_against_gravity_with_closed_valves():
    done = run_scenario(load_scenario("gravity_hold", {"scenario.duration": "6 s"}))
    held = positions_after(done, 1.0)
    creep_deg = np.degrees(np.abs(held - held[0]).max(axis=0))
    assert (creep_deg < 0.05).all(), dict(zip(done.scenario.rig.joints, creep_deg, strict=True))


def test_leaking_pistons_creep():
    """The same bound fails for a machine that does leak (the gripper's small cylinder first)."""
    settings = {"scenario.duration": "3 s"}
    settings |= all_joints("cylinder.cross_port_leakage.conductance_m3_per_s_Pa", "5e-12")
    held = positions_after(run_scenario(load_scenario("gravity_hold", settings)), 1.0)
    assert np.degrees(np.abs(held - held[0]).max()) > 0.05


def test_trapped_oil_holds_the_arms_when_a_hose_bursts():
    scenario = load_scenario("hose_burst", {"scenario.duration": "5 s"})
    done = run_scenario(scenario)
    burst = scenario.supply_lost_at
    assert burst is not None
    signals = done.run.signals
    supply = signals["supply_pressure"][done.run.time > burst + 0.5]
    assert supply.max() < scenario.rig.value("supply.tank_pressure") * 1.01
    after = np.degrees(positions_after(done, burst))
    moved = np.degrees(signals["position"][np.searchsorted(done.run.time, burst)] - signals["position"][0])
    for i, joint in enumerate(scenario.rig.joints):
        if joint.split("_")[1] in LIFTING:
            assert moved[i] > 1.0  # it was on its way up
            assert after[0, i] - after[:, i].min() < 0.5, joint


def mirrored_run(rig: Rig) -> tuple[np.ndarray, np.ndarray]:
    """Both arms under mirrored random voltages; positions of right and left arm, shape (n, 7) each."""
    generator = np.random.default_rng(3)
    times = np.arange(0.0, 2.01, 0.4)
    forward = generator.uniform(-3.0, 3.0, (len(times), 7))
    values = np.zeros((len(times), len(rig.joints)))
    for i, joint in enumerate(rig.joints):
        side, number = joint.split("_")
        sign = -1.0 if side == "left" and number in TURNED else 1.0
        values[:, i] = sign * forward[:, int(number[1]) - 1]
    station = make_station(rig, command=command_source(times, values))
    position = run(station, float(times[-1])).signals["position"]
    right = [rig.joints.index(f"right_j{number}") for number in range(1, 8)]
    left = [rig.joints.index(f"left_j{number}") for number in range(1, 8)]
    return position[:, right], position[:, left]


def test_mirrored_commands_give_mirrored_motion():
    """Table 3.2 gives joint 4 the same range on both arms, so its vane does not stand mirrored: put it there."""
    rig = load_rig("hydrolek")
    zero = rig.value("joints.right_j4.linkage.zero_stroke_position")
    right, left = mirrored_run(rig.with_values({"joints.left_j4.linkage.zero_stroke_position": -zero}))
    signs = np.array([-1.0 if f"j{number}" in TURNED else 1.0 for number in range(1, 8)])
    assert (np.ptp(right, axis=0) > np.radians(0.5)).all()
    assert np.abs(left - signs * right).max() < 1e-6


def test_payload_of_150_kg_lifts_at_full_reach():
    """Section 3.1: 150 kg at full reach; from horizontal with elbow and wrist straight."""
    settings = {
        "scenario.duration": "2 s",
        "scenario.command": "{kind: constant, joints: {right_j2: 5 V}}",
        "scenario.initial_position": "{right_j2: 0 deg, right_j3: 0 deg, right_j5: -5 deg}",
        "effects.load.payload.mass_kg": "150",
    }
    scenario = load_scenario("step_one_joint", settings)
    done = run_scenario(scenario)
    lifted = np.degrees(done.run.signals["position"][:, 0])
    assert lifted.min() > -1.0  # held in balance from the start, it does not drop first
    assert lifted[-1] > 10.0
    pressure = done.run.signals["pressure_a"][done.run.time > 1.0].max()
    assert pressure < scenario.rig.value("supply.pressure") * 1.05
    without = load_scenario("step_one_joint", {**settings, "effects.load.payload.mass_kg": "0"})
    reach = scenario.rig.value("load.payload_gravity_cos") / 9.81
    assert reach > 1.3  # m from the axis
    faster = run_scenario(without).run.signals["position"][-1, 0]
    assert np.degrees(faster) > lifted[-1]


def test_both_arms_share_one_pump():
    """With droop, the left arm's flow takes pressure from the right arm's."""

    def travel(resistance: str, left: str) -> tuple[float, float]:
        settings = {
            "scenario.duration": "0.8 s",
            "scenario.events": "{}",
            "scenario.command": f"{{kind: constant, joints: {{right_j2: 5 V, left_j1: {left}, left_j2: {left}}}}}",
            **all_joints("supply.pressure_droop.resistance_Pa_s_per_m3", resistance),
        }
        scenario = load_scenario("gravity_hold", settings)
        signals = run_scenario(scenario).run.signals
        column = scenario.rig.joints.index("right_j2")
        return float(np.ptp(signals["position"][:, column])), float(signals["supply_pressure"].min())

    alone, pressure_alone = travel("5e10", "0 V")
    shared, pressure_shared = travel("5e10", "5 V")
    assert pressure_shared < pressure_alone < 16e6
    assert shared < 0.97 * alone
    assert travel("0", "5 V")[0] == pytest.approx(
        travel("0", "0 V")[0], rel=1e-9
    )  # nothing else couples them


def test_moments_and_mount_forces_are_the_same_by_virtual_work():
    ends = [
        run_scenario(
            load_scenario("both_arms", {"scenario.duration": "1.5 s", "scenario.forces": forces})
        ).run.signals["position"][-1]
        for forces in ("mounts", "moments")
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-6


def test_a_recorded_run_of_one_joint_agrees_with_the_rollout():
    """The command written beside the signals is the one that acted: a replay of it meets the diagram."""
    from hydrolek_drake.rollout import roll_out
    from hydrolek_drake.runs.signals import named_signals

    scenario = load_scenario("random_one_joint", {"scenario.duration": "4 s"})
    done = run_scenario(scenario)
    signals, _ = named_signals(done)
    outcome = roll_out(
        scenario.rig.records(), done.run.time, signals["joint.command"], done.run.time, longest_step=2e-4
    )
    difference = np.degrees(outcome.signals.reading) - signals["joint.angle"]
    assert np.abs(difference).max() < 0.02


def test_divergence_is_told_with_a_remedy():
    """Joint 3 at full speed into its stop: too stiff for this step."""
    settings = {
        "scenario.duration": "0.8 s",
        "scenario.command": "{kind: constant, joints: {left_j3: 5 V}}",
        "scenario.integration": "{step: 2 ms, integrator: runge_kutta2}",
    }
    with pytest.raises(InputError, match=r"diverged .*scenario.integration.step=0.5 ms"):
        run_scenario(load_scenario("gravity_hold", settings))


# --- ports, feedthrough, interruption ------------------------------------------------------------------------

N = 14
OUTSIDE = {"outside": 15 * N}  # what a law for physics in no list adds; open where a rig has none
ENDS = 18  # ten linear cylinders push two links each, but those of joint 1 stand on the fixed base
PORTS = {
    "operator_computer": ({"signal_commanded": N}, {"channel_voltage": 32}),
    "field_point": ({"channel_voltage": 32}, {"command": N}),
    "transport_delay": ({"command": N, **OUTSIDE}, {"voltage_delayed": N, "voltage_arriving": N}),
    "proportional_amplifier": ({"voltage_delayed": N, **OUTSIDE}, {"coil_current": 2 * N}),
    "solenoid_spool": (
        {"coil_current": 2 * N, "pressure": 2 * N, "supply_pressure": 1, **OUTSIDE},
        {"spool_position": N},
    ),
    "four_way_valve": (
        {"spool_position": N, "pressure": 2 * N, "supply_pressure": 1, **OUTSIDE},
        {"oil_flow": 3 * N},
    ),
    "supply": ({"oil_flow": 3 * N, "pressure_available": 1, **OUTSIDE}, {"supply_pressure": 1}),
    "actuator": ({"oil_flow": 3 * N, "rod_motion": 2 * N, **OUTSIDE}, {"pressure": 2 * N, "rod_force": N}),
    "linkage": (
        {"plant_state": 2 * N, "side_motion": 2 * N, "rod_force": N},
        {"joint_motion": 2 * N, "rod_motion": 2 * N, "moment": N, "mount_force": 3 * ENDS},
    ),
    "mounts": ({"command": 3 * ENDS, "body_poses": 0}, {"spatial_forces": 0}),
    "load": ({"plant_state": 2 * N, "moment": N, **OUTSIDE}, {"joint_torque": N}),
    "potentiometer": (
        {"motion": 2 * N, **OUTSIDE},
        {"position_measured": N, "position_ideal": N, "potentiometer_voltage": N},
    ),
}
FEEDS_THROUGH = {
    "operator_computer": {("signal_commanded", "channel_voltage")},
    "field_point": {("channel_voltage", "command")},
    "transport_delay": {("outside", "voltage_arriving")},
    "proportional_amplifier": {("voltage_delayed", "coil_current"), ("outside", "coil_current")},
    "solenoid_spool": set(),
    "four_way_valve": {
        ("spool_position", "oil_flow"),
        ("pressure", "oil_flow"),
        ("supply_pressure", "oil_flow"),
        ("outside", "oil_flow"),
    },
    "supply": {("pressure_available", "supply_pressure"), ("outside", "supply_pressure")},
    "actuator": {("rod_motion", "rod_force"), ("outside", "rod_force")},
    "linkage": {
        ("plant_state", "joint_motion"),
        ("plant_state", "rod_motion"),
        ("plant_state", "moment"),
        ("plant_state", "mount_force"),
        ("rod_force", "moment"),
        ("rod_force", "mount_force"),
    },
    "mounts": {("command", "spatial_forces"), ("body_poses", "spatial_forces")},
    "load": {("plant_state", "joint_torque"), ("moment", "joint_torque"), ("outside", "joint_torque")},
    "potentiometer": {
        ("motion", "position_measured"),
        ("motion", "position_ideal"),
        ("motion", "potentiometer_voltage"),
        ("outside", "position_measured"),
        ("outside", "position_ideal"),
        ("outside", "potentiometer_voltage"),
    },
}


@pytest.fixture(scope="module")
def machine():
    return make_station(load_rig("hydrolek"), operator=True)


def test_machine_is_made_of_these_systems(machine):
    assert set(machine.systems) == set(PORTS)
    diagram = machine.diagram
    inputs = {diagram.get_input_port(i).get_name(): diagram.get_input_port(i).size() for i in range(2)}
    outputs = [diagram.get_output_port(i).get_name() for i in range(diagram.num_output_ports())]
    assert inputs == {"signal_commanded": N, "pressure_available": 1}
    assert {"position_measured", "potentiometer_voltage", "pressure_measured", "joint_motion_true"} == set(
        outputs
    )


@pytest.mark.parametrize("name", sorted(PORTS))
def test_ports_have_names_and_sizes(machine, name):
    system = machine.systems[name]
    ins = [system.get_input_port(i) for i in range(system.num_input_ports())]
    outs = [system.get_output_port(i) for i in range(system.num_output_ports())]
    assert ({p.get_name(): p.size() for p in ins}, {p.get_name(): p.size() for p in outs}) == PORTS[name]


@pytest.mark.parametrize("name", sorted(FEEDS_THROUGH))
def test_feedthrough_is_declared_as_it_is(machine, name):
    system = machine.systems[name]
    found = {
        (system.get_input_port(i).get_name(), system.get_output_port(o).get_name())
        for i in range(system.num_input_ports())
        for o in range(system.num_output_ports())
        if system.HasDirectFeedthrough(i, o)
    }
    assert found == FEEDS_THROUGH[name]


def test_interrupted_run_keeps_what_is_done():
    rig = load_rig("joint_bench")
    station = make_station(
        rig, sizes=StepSizes(), command=command_source(np.array([0.0, 5.0]), np.ones((2, 1)))
    )

    def stop(time: float) -> None:
        if time >= 1.0:
            raise KeyboardInterrupt

    outcome = run(station, 5.0, on_progress=stop, keep_interrupted=True)
    assert outcome.interrupted and outcome.time[-1] == pytest.approx(1.0)
    assert {len(values) for values in outcome.signals.values()} == {len(outcome.time)}
    with pytest.raises(KeyboardInterrupt):
        run(station, 5.0, on_progress=stop)
