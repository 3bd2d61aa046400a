"""Measuring the executions side by side in one run."""

import platform
import resource
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.benchmark.commands import measure_commands
from hydrolek_drake.benchmark.lanes import measure_jacobians, measure_lanes
from hydrolek_drake.benchmark.lanes_together import measure_jacobian_together, measure_lanes_together
from hydrolek_drake.benchmark.plain_bench import simulate_plainly
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.together.together import JointsTogether
from hydrolek_drake.station.simulation import command_source, run
from hydrolek_drake.station.station import make_station
from hydrolek_drake.station.step_sizes import StepSizes

REFERENCE_STEP = 1e-5  # seconds; the step that the rollout's error is measured against


@dataclass(frozen=True)
class Speed:
    """Simulated seconds per second of one execution: median, lowest and highest of the runs."""

    name: str
    times_real_time: float
    lowest: float
    highest: float
    runs: int


def random_voltage(
    duration: float, joints: int, generator: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Random levels within +-4 V, held for half a second, one column per joint."""
    times = np.arange(0.0, duration, 0.01)
    levels = generator.uniform(-4.0, 4.0, (int(duration / 0.5) + 1, joints))
    return times, levels[(times / 0.5).astype(int)]


def measure(
    seed: int, repeats: int, report: Callable[[str], None], pairs: Path | None = None
) -> dict[str, Any]:
    """All figures of the benchmark.

    Args:
        seed: of the random voltages.
        repeats: runs of each execution; the median counts.
        report: told what is measured next.
        pairs: folder of recordings for `measure_commands`; None to leave these out.
    """
    commands = [] if pairs is None else measure_commands(pairs, report)
    generator = np.random.default_rng(seed)
    speeds: list[Speed] = []
    whole = load_rig("hydrolek")
    times, volts = random_voltage(5.0, len(whole.joints), generator)
    for label, integrator, mount_forces in (
        ("symplectic Euler, joint moments", "symplectic_euler", False),
        ("symplectic Euler, mount forces", "symplectic_euler", True),
        ("Runge-Kutta 2, mount forces", "runge_kutta2", True),
        ("Runge-Kutta 3, mount forces", "runge_kutta3", True),
    ):
        report(f"both arms as a Drake diagram, 1 ms, {label}")
        sizes = StepSizes(step=1e-3, integrator=integrator, mount_forces=mount_forces)
        speeds.append(
            _diagram_speed(f"diagram, both arms, 1 ms, {label}", whole, times, volts, sizes, repeats)
        )
    report("both arms compiled")
    together = JointsTogether(whole, whole.joints)
    own_records, own_step = whole.records(), whole.value("integration.longest_step")
    rest = own_records["load"]["initial_position"]

    def all_joints() -> None:
        together.roll_out(own_records, times, volts, times, rest)

    all_joints()
    all_name = f"rollout, both arms, {own_step * 1e3:g} ms"
    speeds.append(_speed(all_name, times[-1], all_joints, repeats))
    of_all = measure_lanes_together(whole, times, volts, repeats, report)
    jacobian_of_all = measure_jacobian_together(whole, times, volts, repeats, report)
    rig = load_rig("joint_bench")
    times, volts = random_voltage(40.0, 1, generator)
    report("one joint as a Drake diagram")
    short = times < 10.0
    speeds.append(
        _diagram_speed(
            "diagram, one joint, 1 ms", rig, times[short], volts[short], StepSizes(step=1e-3), repeats
        )
    )
    report("one joint compiled")
    records, step = rig.records(), rig.value("integration.longest_step")
    spool_steps = round(rig.value("integration.spool_steps"))
    command = np.ascontiguousarray(volts[:, 0])

    def rollout(longest_step: float = step) -> np.ndarray:
        return roll_out(
            records, times, command, times, longest_step=longest_step, spool_steps=spool_steps
        ).signals.position

    rollout()
    speeds.append(_speed(f"rollout, one joint, {step * 1e3:g} ms", times[-1], rollout, 5 * repeats))
    lanes = measure_lanes(times, command, 5, report)
    jacobians = measure_jacobians(times, command, 5, report)
    report("error of the rollout against its reference")
    reference = rollout(REFERENCE_STEP)
    error = np.degrees(rollout() - reference)
    report("the same joint with SciPy's LSODA")
    few = times < 5.0
    plain = _speed("SciPy LSODA, one joint", 5.0, lambda: simulate_plainly(rig, times[few], command[few]), 1)
    speeds.append(plain)
    parting = np.degrees(simulate_plainly(rig, times[few], command[few]) - reference[few])
    by_name = {s.name: s for s in speeds}
    fast = by_name[f"rollout, one joint, {step * 1e3:g} ms"]
    return {
        "schema": 1,
        "machine": f"{platform.machine()}, Python {platform.python_version()}",
        "speeds": [asdict(s) for s in speeds],
        "ratios": {
            f"rollout over {s.name}": fast.times_real_time / s.times_real_time
            for s in speeds
            if s is not fast
        },
        "lanes": [asdict(row) for row in (*lanes, *of_all)],
        "jacobians": [asdict(row) for row in (*jacobians, jacobian_of_all)],
        "commands": [asdict(row) for row in commands],
        "rollout_error_deg": {
            "rms": float(np.sqrt(np.mean(error**2))),
            "largest": float(np.abs(error).max()),
        },
        "lsoda_against_reference_deg": {"largest": float(np.abs(parting).max())},
        "peak_memory_MB": _peak_memory_mb(),
    }


def _diagram_speed(
    name: str, rig: Any, times: np.ndarray, volts: np.ndarray, sizes: StepSizes, repeats: int
) -> Speed:
    def once(duration: float) -> None:
        station = make_station(rig, sizes=sizes, command=command_source(times, volts))
        begin = time.perf_counter()
        run(station, duration)
        taken.append(duration / (time.perf_counter() - begin))

    taken: list[float] = []
    once(0.05)
    taken.clear()
    for _ in range(repeats):
        once(float(times[-1]))
    return Speed(name, statistics.median(taken), min(taken), max(taken), len(taken))


def _speed(name: str, duration: float, work: Callable[[], Any], repeats: int) -> Speed:
    taken = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        taken.append(duration / (time.perf_counter() - begin))
    return Speed(name, statistics.median(taken), min(taken), max(taken), len(taken))


def _peak_memory_mb() -> float:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak / 1e3
