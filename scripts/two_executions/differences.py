"""How far readings of the Diagram are from those of the rollout: under a random voltage, and in closed loop."""

from dataclasses import replace

import numpy as np

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.closed_loop import loop_on_rollout
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rigs.machine.rig import Rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes, sizes_for


def random_voltage(duration: float, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Multi-level random voltage of section 6.1.4: levels within +-4 V, each held for 0.2 to 1 s."""
    times = np.arange(0.0, duration + 0.005, 0.01)
    volts = np.zeros(len(times))
    begin = 0.0
    while begin < duration:
        volts[times >= begin - 1e-9] = generator.uniform(-4.0, 4.0)
        begin += round(generator.uniform(0.2, 1.0), 2)
    return times, volts


def compare(rig: Rig, duration: float, step: float, *seeds: int) -> list[tuple[float, float]]:
    """Root mean square and largest difference of each joint's readings [deg], driven by one seed each."""
    drives = [random_voltage(duration, np.random.default_rng(seed)) for seed in seeds]
    times = drives[0][0]
    volts = np.column_stack([volts for _, volts in drives])
    station = make_station(rig, sizes=StepSizes(step=step), command=command_source(times, volts))
    readings = run(station, duration).signals["reading"]
    figures = []
    for i in range(len(rig.joints)):
        command = np.ascontiguousarray(volts[:, i])
        outcome = roll_out(rig.records()[i : i + 1], times, command, times, longest_step=step / 5.0)
        count = min(len(readings), len(times))
        difference = np.degrees(readings[:count, i] - outcome.signals.reading[:count])
        figures.append((float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())))
    return figures


def closed(joint: str, controllers: tuple[str, ...], step: float | None = None) -> list[float]:
    """Largest difference of a controlled joint's readings [deg], controller by controller.

    The joint is brought 18 deg forward and 11 deg back, with three seconds for each way.

    Args:
        joint: rig of one joint.
        controllers: of the catalogue.
        step: of the diagram [s]; the rig's own (`sizes_for`) if not given. The rollout takes its own.
    """
    rig = load_rig(joint)
    [name] = rig.joints
    setting, records = rig_setting(rig, name), rig.records()
    start = float(np.degrees(records["load"]["initial_position"][0]))
    wanted = np.repeat([start + 18.0, start + 7.0], round(3.0 / sample_s()))
    sizes = replace(sizes_for(rig), mount_forces=False)
    sizes = sizes if step is None else replace(sizes, step=step)
    figures = []
    for controller in controllers:
        law = build_law(controller, setting, noisy=False)
        diagram = run_controlled(rig, {name: law}, wanted[:, np.newaxis], sample_s(), sizes=sizes)
        plain = loop_on_rollout(
            law, records, wanted, sample_s(),
            rows_per_sample=1, longest_step=rig.value("integration.longest_step"),
        )  # fmt: skip
        figures.append(
            float(np.abs(diagram.angle_deg[:, 0] - plain.angle_deg[: len(diagram.angle_deg)]).max())
        )
    return figures
