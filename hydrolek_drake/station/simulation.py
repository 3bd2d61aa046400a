"""Running a station: initial state, integration, events, and the signals that come out."""

import gc
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from hydrolek_drake.physics import cylinder, load
from hydrolek_drake.rollout.rest import rest_pressures, rest_tilt_and_lead
from hydrolek_drake.station.plant import Payload
from hydrolek_drake.station.station import Station
from hydrolek_drake.station.step_sizes import INTEGRATORS

_EARLY = (
    1e-9  # seconds by which a played-back command comes early, so that rounding never makes it a step late
)


@dataclass(frozen=True)
class Run:
    """Signals of a run: one row per time, one column per joint, in SI units.

    Attributes:
        time: [s], shape (n,).
        signals: `reading`, `measured`, `position`, `velocity`, `voltage`, and for hydraulic rigs `pressure_a`,
            `pressure_b`, `spool`, `force` (n, joints) and `supply_pressure` (n, 1); for electric ones `force` and
            `current` (n, joints).
        final: context after the run.
        interrupted: whether the user stopped it before its end.
    """

    time: np.ndarray
    signals: dict[str, np.ndarray]
    final: Context
    interrupted: bool = False


def command_source(times: np.ndarray, values: np.ndarray) -> TrajectorySource:
    """Plays back recorded commands, each held until the next.

    Args:
        times: [s], increasing, shape (m,).
        values: [V], shape (m, joints).
    """
    breaks = np.append(np.asarray(times, float) - _EARLY, times[-1] + 1.0)
    held = np.vstack([values, values[-1:]]).T
    last = np.append(np.diff(breaks) > 0.0, True)  # of those that fall on one time
    source = TrajectorySource(PiecewisePolynomial.ZeroOrderHold(breaks[last], held[:, last]))
    source.set_name("command_player")
    return source


def without_payloads_to_come(station: Station, context: Context) -> list[Payload]:
    """Take from the tools what is picked up later than the context's time; what that is."""
    plant_context = station.plant.GetMyMutableContextFromRoot(context)
    to_come = [payload for payload in station.payloads if payload.time > context.get_time()]
    for payload in to_come:
        payload.body.SetMass(plant_context, 0.0)
    return to_come


def initial_context(station: Station, positions: np.ndarray | None = None) -> Context:
    """A context at rest in balance at the given joint positions (the rig's own if None)."""
    context = station.diagram.CreateDefaultContext()
    plant_context = station.plant.GetMyMutableContextFromRoot(context)
    joints = station.joints
    q = np.array(joints["load"]["initial_position"] if positions is None else positions, dtype=float)
    for name, value in zip(station.rig.joints, q, strict=True):
        joint = station.plant.GetJointByName(name)
        station.plant.SetPositions(
            plant_context, _placed(station, plant_context, joint.position_start(), value)
        )
    without_payloads_to_come(station, context)
    gravity = station.plant.CalcGravityGeneralizedForces(plant_context)
    needed = np.array(
        [-gravity[station.plant.GetJointByName(name).velocity_start()] for name in station.rig.joints]
    )
    needed = needed + np.where(
        joints["load"]["variant"] == load.SLIDING, np.nan_to_num(joints["load"]["gravity_cos"]), 0.0
    )
    tilts, leads = np.zeros(len(q)), q.copy()
    for i, joint_record in enumerate(joints):
        tilts[i], leads[i] = rest_tilt_and_lead(joint_record, q[i], needed[i])
    if "actuator" in station.systems and not cylinder.electric(joints).any():
        pressures = np.array(
            [rest_pressures(record, leads[i] - tilts[i], needed[i]) for i, record in enumerate(joints)]
        )
        actuator = station.systems["actuator"]
        actuator.rest(actuator.GetMyMutableContextFromRoot(context), pressures)
        if "long_lines" in station.systems:
            lines = station.systems["long_lines"]
            lines.rest(lines.GetMyMutableContextFromRoot(context), pressures)
    if "electric_motor" in station.systems:
        motor = station.systems["electric_motor"]
        held = joints["linkage"]["direction"] * needed
        motor.rest(motor.GetMyMutableContextFromRoot(context), held)
    zero = np.zeros(len(q))
    for name, state in (("play", leads), ("rocking_base", tilts)):
        if name in station.systems:
            station.systems[name].GetMyMutableContextFromRoot(context).SetContinuousState(
                np.concatenate([state, zero])
            )
    sensor_context = station.systems["potentiometer"].GetMyMutableContextFromRoot(context)
    sensor_context.SetDiscreteState(0, q - tilts)
    return context


def _placed(station: Station, plant_context: Context, index: int, value: float) -> np.ndarray:
    positions = station.plant.GetPositions(plant_context).copy()
    positions[index] = value
    return positions


def run(
    station: Station,
    duration: float,
    *,
    start: float = 0.0,
    context: Context | None = None,
    supply_lost_at: float | None = None,
    realtime_rate: float = 0.0,
    on_progress: Callable[[float], None] | None = None,
    keep_interrupted: bool = False,
) -> Run:
    """Run a station.

    Args:
        station: built with `make_station`; its command input must be connected or fixed.
        duration: [s].
        start: time of the first sample [s].
        context: where to start; None for rest.
        supply_lost_at: when a hose bursts, that is the supply falls to tank pressure [s].
        realtime_rate: 1 to run no faster than real time, 0 as fast as possible.
        on_progress: called with the simulated time now and then; may raise to stop.
        keep_interrupted: on Ctrl-C return the signals so far instead of raising KeyboardInterrupt.
    """
    context = initial_context(station) if context is None else context
    context.SetTime(start)
    _fix_supply(station, context, 1.0)
    simulator = Simulator(station.diagram, context)
    config = SimulatorConfig(
        integration_scheme=INTEGRATORS[station.sizes.integrator],
        max_step_size=station.sizes.step,
        use_error_control=False,
        target_realtime_rate=realtime_rate,
        start_time=start,
    )
    ApplySimulatorConfig(config, simulator)
    simulator.Initialize()
    end = start + duration
    events: list[tuple[float, Callable[[], None]]] = []
    plant_context = station.plant.GetMyMutableContextFromRoot(context)
    for payload in station.payloads:
        if start < payload.time < end:
            events.append((payload.time, partial(payload.body.SetMass, plant_context, payload.mass)))
    if supply_lost_at is not None and start <= supply_lost_at < end:
        events.append((supply_lost_at, partial(_fix_supply, station, context, 0.0)))
    interrupted = False
    collecting = gc.isenabled()
    gc.disable()  # the callbacks leave no cycles behind, and looking for some takes a tenth of the time
    try:
        for time, act in [*sorted(events, key=lambda e: e[0]), (end, lambda: None)]:
            _advance(simulator, time, on_progress)
            act()
    except KeyboardInterrupt:
        if not keep_interrupted:
            raise
        interrupted = True
    finally:
        if collecting:
            gc.enable()
    return Run(*_collect(station, context), final=context, interrupted=interrupted)


def _advance(simulator: Simulator, until: float, on_progress: Callable[[float], None] | None) -> None:
    now = simulator.get_context().get_time()
    while on_progress is not None and now + 0.5 < until:
        now += 0.5
        simulator.AdvanceTo(now)
        on_progress(now)
    simulator.AdvanceTo(until)


def _fix_supply(station: Station, context: Context, share: float) -> None:
    for index in range(station.diagram.num_input_ports()):
        port = station.diagram.get_input_port(index)
        if port.get_name() == "pressure_available":
            port.FixValue(context, [share])


def _collect(station: Station, context: Context) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    n = len(station.rig.joints)
    data = {name: log.FindLog(context) for name, log in station.logs.items()}
    count = min(log.num_samples() for log in data.values())  # an interrupt may come between two logs
    signals = {name: log.data()[:, :count].T.copy() for name, log in data.items()}
    motion = signals.pop("motion")
    signals["position"], signals["velocity"] = motion[:, :n], motion[:, n:]
    if "pressure" in signals:
        pressure = signals.pop("pressure")
        signals["pressure_a"], signals["pressure_b"] = pressure[:, :n], pressure[:, n:]
    return next(iter(data.values())).sample_times()[:count].copy(), signals
