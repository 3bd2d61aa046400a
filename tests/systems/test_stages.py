"""Each stage's LeafSystem on a bare context: ports, values, feedthrough."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import (
    amplifier,
    command,
    cylinder,
    fluid,
    linkage,
    load,
    rod_friction,
    sensor,
    solenoid,
)
from hydrolek_drake.physics.valves.openings import openings
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.systems.actuator import Actuator
from hydrolek_drake.systems.electric_motor import ElectricMotor
from hydrolek_drake.systems.four_way_valve import FourWayValve
from hydrolek_drake.systems.operator_computer import FieldPoint, OperatorComputer
from hydrolek_drake.systems.play import Play
from hydrolek_drake.systems.potentiometer import Potentiometer
from hydrolek_drake.systems.proportional_amplifier import ProportionalAmplifier
from hydrolek_drake.systems.rocking_base import RockingBase
from hydrolek_drake.systems.solenoid_spool import SolenoidSpool
from hydrolek_drake.systems.supply import Supply
from hydrolek_drake.systems.transport_delay import TransportDelay

JOINTS = load_rig("hydrolek").records()
N = len(JOINTS)


def evaluate(system, port, **inputs):
    context = system.CreateDefaultContext()
    for name, value in inputs.items():
        system.GetInputPort(name).FixValue(context, np.asarray(value, float))
    return system.GetOutputPort(port).Eval(context)


def test_operator_computer_puts_table_3_1_on_the_channels():
    signal = np.zeros(N)
    right_j5 = list(load_rig("hydrolek").joints).index("right_j5")
    signal[right_j5] = 40.0  # the thesis's example: joint 5 of the right arm upwards is module 4, channel 0
    channels = evaluate(OperatorComputer(JOINTS), "channel_voltage", signal_commanded=signal)
    module_4 = channels[8:16]
    p = JOINTS[right_j5]["command"]
    assert module_4[0] == pytest.approx(p["calibration_a"] + 0.4 * (p["calibration_b"] - p["calibration_a"]))
    assert np.count_nonzero(channels) == 1


def test_field_point_undoes_the_channels():
    signal = np.linspace(-90.0, 95.0, N)
    channels = evaluate(OperatorComputer(JOINTS), "channel_voltage", signal_commanded=signal)
    volts = evaluate(FieldPoint(JOINTS), "command", channel_voltage=channels)
    expected = [np.subtract(*command.calibrated_voltages(s, j)) for s, j in zip(signal, JOINTS, strict=True)]
    np.testing.assert_allclose(volts, expected, rtol=1e-14)


def test_operator_computer_refuses_shared_channels_and_uncalibrated_rigs():
    twice = JOINTS.copy()
    twice[1]["command"]["channel_a"] = twice[0]["command"]["channel_a"]
    with pytest.raises(InputError, match="share a channel"):
        OperatorComputer(twice)
    with pytest.raises(InputError, match="calibrated"):
        OperatorComputer(load_rig("joint_bench").records())


def pulse_through_the_delay(delay, step=1e-3, at=3, steps=40):
    """What a pulse of 5 V in step `at` gives: means over each step, and samples arriving in each."""
    joints = load_rig("joint_bench").with_values({"command.delay": delay}).records()
    system = TransportDelay(joints, step)
    context = system.CreateDefaultContext()
    means, arriving = [], []
    for k in range(steps):
        system.GetInputPort("command").FixValue(context, [5.0 if k == at else 0.0])
        arriving.append(system.GetOutputPort("voltage_arriving").Eval(context)[0])
        values = context.get_discrete_state().Clone()
        system._update(context, values)
        context.get_mutable_discrete_state().SetFrom(values)
        means.append(system.GetOutputPort("voltage_delayed").Eval(context)[0])
    return np.array(means), np.array(arriving)


def test_transport_delay_keeps_the_integral_of_the_voltage():
    """A pulse delayed by 18.4 steps comes out spread over two steps with the same area."""
    means, _ = pulse_through_the_delay(18.4e-3)
    np.testing.assert_allclose(means[[21, 22]], [0.6 * 5.0, 0.4 * 5.0], rtol=1e-9)
    assert sum(means) == pytest.approx(5.0)


@pytest.mark.parametrize(("delay", "step_of_arrival"), [(18.4e-3, 21), (18e-3, 21), (0.4e-3, 3), (0.0, 3)])
def test_a_sample_arrives_in_the_step_in_which_its_delay_ends(delay, step_of_arrival):
    _, arriving = pulse_through_the_delay(delay)
    assert list(np.flatnonzero(arriving)) == [step_of_arrival]


def test_proportional_amplifier_is_equation_4_4():
    volts = np.linspace(-11.0, 11.0, N)
    currents = evaluate(ProportionalAmplifier(JOINTS, 1e-3), "coil_current", voltage_delayed=volts)
    expected = np.array([amplifier.coil_currents(v, 0.0, j) for v, j in zip(volts, JOINTS, strict=True)])
    np.testing.assert_array_equal(currents, expected.T.ravel())


def test_solenoid_spool_advances_with_the_shared_step():
    step, currents = 1e-3, np.linspace(0.1, 0.9, 2 * N)
    system = SolenoidSpool(JOINTS, step, 1)
    context = system.CreateDefaultContext()
    system.GetInputPort("coil_current").FixValue(context, currents)
    values = system.AllocateDiscreteVariables()
    system._update(context, values)
    expected = [
        solenoid.advance(0.0, 0.0, currents[i], currents[N + i], step, 1, JOINTS[i]) for i in range(N)
    ]
    np.testing.assert_array_equal(values.get_vector(0).get_value()[: 2 * N], np.array(expected).T.ravel())
    np.testing.assert_array_equal(values.get_vector(1).get_value(), 0.5 * np.array(expected)[:, 0])


def test_new_currents_reach_the_spool_where_the_delay_ends():
    """With a delay of 18.4 steps the currents of the step before act for 0.4 of a step."""
    step, first, second = 1e-3, np.array([0.9, 0.2]), np.array([0.2, 0.7])
    joints = load_rig("hydrolek_right_j2").with_values({"command.delay": 18.4e-3}).records()
    system = SolenoidSpool(joints, step, 1)
    context = system.CreateDefaultContext()
    for currents in (first, second):
        system.GetInputPort("coil_current").FixValue(context, currents)
        values = context.get_discrete_state().Clone()
        system._update(context, values)
        context.get_mutable_discrete_state().SetFrom(values)
    x, v = 0.0, 0.0
    places = []
    for currents, share in ((first, 0.4), (first, 0.6), (first, 0.4), (second, 0.6)):
        x, v = solenoid.advance(x, v, *currents, share * step, 1, joints[0])
        places.append(x)
    np.testing.assert_allclose(values.get_vector(0).get_value()[:2], [x, v], rtol=1e-9)
    mean = 0.4 * 0.5 * (places[1] + places[2]) + 0.6 * 0.5 * (places[2] + places[3])
    np.testing.assert_allclose(values.get_vector(1).get_value(), [mean], rtol=1e-9)


def test_four_way_valve_conserves_oil():
    """What enters the chambers without leakage comes from the pump or goes to the tank, edge by edge."""
    rng = np.random.default_rng(4)
    x = rng.uniform(-0.2e-3, 0.2e-3, N)
    pressure = rng.uniform(1e6, 15e6, 2 * N)
    flow = evaluate(
        FourWayValve(JOINTS), "oil_flow", spool_position=x, pressure=pressure, supply_pressure=[15.3e6]
    ).reshape(3, N)
    for i, joint in enumerate(JOINTS):
        open_a, _, open_b, _ = openings(x[i], joint)
        drop_a, drop_b = 15.3e6 - pressure[i], 15.3e6 - pressure[N + i]
        p = joint["valve"]
        drawn = open_a * fluid.orifice_conductance(p["max_area_a"], drop_a, p["discharge"], joint) * drop_a
        drawn += open_b * fluid.orifice_conductance(p["max_area_b"], drop_b, p["discharge"], joint) * drop_b
        assert flow[2, i] == pytest.approx(drawn, rel=1e-12, abs=1e-18)


def test_supply_falls_to_the_tank_when_a_hose_bursts():
    system = Supply(JOINTS, 1e-3)
    flow = np.zeros(3 * N)
    assert evaluate(system, "supply_pressure", oil_flow=flow)[0] == JOINTS[0]["supply"]["pressure"]
    lost = evaluate(system, "supply_pressure", oil_flow=flow, pressure_available=[0.0])[0]
    assert lost == JOINTS[0]["supply"]["tank_pressure"]


def test_actuator_state_and_force():
    rng = np.random.default_rng(5)
    pressure, flow = rng.uniform(1e6, 9e6, 2 * N), rng.uniform(-1e-5, 1e-5, 3 * N)
    motion = np.concatenate([rng.uniform(0.01, 0.03, N), rng.uniform(-0.02, 0.02, N)])
    joints, bent = JOINTS.copy(), rng.uniform(-0.9, 0.9, N)
    joints["cylinder"]["bristle_deflection"] = 2e-5
    joints["effects"]["cylinder_coulomb_friction"]["coulomb_N"] = 400.0
    system = Actuator(joints, 0.0)
    context = system.CreateDefaultContext()
    context.SetContinuousState(np.concatenate([pressure, bent]))
    system.GetInputPort("oil_flow").FixValue(context, flow)
    system.GetInputPort("rod_motion").FixValue(context, motion)
    rates = system.EvalTimeDerivatives(context).CopyToVector()
    force = system.GetOutputPort("rod_force").Eval(context)
    for i, joint in enumerate(joints):
        a, b, _, _ = cylinder.pressure_rates(
            pressure[i], pressure[N + i], flow[i], flow[N + i], motion[i], motion[N + i], joint
        )
        assert (rates[i], rates[N + i]) == (a, b)
        assert rates[2 * N + i] == rod_friction.bent_rate(bent[i], motion[N + i], joint)
        friction, _, _ = rod_friction.friction_force(motion[i], motion[N + i], bent[i], 0.0, 0.0, joint)
        p = joint["cylinder"]
        assert force[i] == pytest.approx(p["area_a"] * pressure[i] - p["area_b"] * pressure[N + i] - friction)


def test_electric_motor_is_a_force_constant():
    joints = load_rig("emps").records()
    force = evaluate(ElectricMotor(joints), "rod_force", voltage_delayed=[-1.7])
    assert force[0] == pytest.approx(-1.7 * joints[0]["cylinder"]["force_constant"])


def test_potentiometer_reads_volts_of_table_3_2():
    rig = load_rig("hydrolek_right_j2")
    angle = np.radians(30.0)
    volts = evaluate(Potentiometer(rig.records(), 1e-3, None), "potentiometer_voltage", motion=[angle, 0.0])
    assert volts[0] == pytest.approx(2.794 + 0.164 * 30.0)


def test_noise_and_resolution_come_from_the_rig_and_the_generator():
    joints = load_rig("joint_bench").records()
    readings = []
    for seed in (1, 1, 2):
        system = Potentiometer(joints, 1e-3, np.random.default_rng(seed))
        context = system.CreateDefaultContext()
        system.GetInputPort("motion").FixValue(context, [0.4, 0.0])
        values = system.AllocateDiscreteVariables()
        series = []
        for _ in range(2000):
            values.SetFrom(context.get_discrete_state())
            system._update(context, values)
            context.SetDiscreteState(1, values.get_vector(1).get_value())
            series.append(system.GetOutputPort("position_measured").Eval(context)[0])
        readings.append(np.array(series))
    np.testing.assert_array_equal(readings[0], readings[1])
    assert np.any(readings[0] != readings[2])
    p = joints[0]["sensor"]
    assert readings[0].std() == pytest.approx(float(p["noise"]), rel=0.1)
    steps = readings[0] / p["resolution"]
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


@pytest.mark.parametrize(
    ("system", "direct"),
    [
        (TransportDelay(JOINTS, 1e-3), {("outside", "voltage_arriving")}),
        (SolenoidSpool(JOINTS, 1e-3, 1), set()),
        (
            ProportionalAmplifier(JOINTS, 1e-3),
            {("voltage_delayed", "coil_current"), ("outside", "coil_current")},
        ),
        (
            FourWayValve(JOINTS),
            {(name, "oil_flow") for name in ("spool_position", "pressure", "supply_pressure", "outside")},
        ),
        (Supply(JOINTS, 1e-3), {(name, "supply_pressure") for name in ("pressure_available", "outside")}),
        (Actuator(JOINTS, 0.0), {(name, "rod_force") for name in ("rod_motion", "outside")}),
        (Actuator(JOINTS, 1e-3), {(name, "rod_force") for name in ("rod_motion", "outside", "oil_flow")}),
        (
            Play(JOINTS),
            {
                ("joint_motion", "side_motion"),
                ("joint_motion", "moment_transmitted"),
                ("moment", "moment_transmitted"),
            },
        ),
        (RockingBase(JOINTS), {("motion", "motion_relative")}),
    ],
    ids=lambda value: value.get_name() if hasattr(value, "get_name") else "",
)
def test_feedthrough_is_what_it_must_be(system, direct):
    """Loops of pressure, force and motion stay free of algebraic cycles; a law sees nothing but states."""
    found = {
        (system.get_input_port(i).get_name(), system.get_output_port(o).get_name())
        for i in range(system.num_input_ports())
        for o in range(system.num_output_ports())
        if system.HasDirectFeedthrough(i, o)
    }
    assert found == direct


def test_play_passes_joints_without_play_through():
    motion, moment = np.linspace(0.1, 1.0, 2 * N), np.linspace(-5.0, 5.0, N)
    system = Play(JOINTS)
    np.testing.assert_array_equal(evaluate(system, "side_motion", joint_motion=motion, moment=moment), motion)
    transmitted = evaluate(system, "moment_transmitted", joint_motion=motion, moment=moment)
    np.testing.assert_array_equal(transmitted, moment)


def test_rod_inertia_reflects_with_the_lever_of_mid_travel():
    for joint in JOINTS:
        if joint["cylinder"]["rod_mass"] > 0.0:
            middle = 0.5 * (joint["load"]["lower_stop"] + joint["load"]["upper_stop"])
            _, lever = linkage.stroke_and_lever(middle, joint)
            assert load.reflected_rod_inertia(joint) == pytest.approx(
                joint["cylinder"]["rod_mass"] * lever**2
            )


def test_sensor_bow_vanishes_at_both_ends():
    joint = (
        load_rig("joint_bench").with_values({"effects.sensor.nonlinearity.amplitude_rad": 0.02}).records()[0]
    )
    for end in ("travel_lower", "travel_upper"):
        position = float(joint["sensor"][end])
        assert sensor.reading(position, 0.0, joint) == pytest.approx(position)
