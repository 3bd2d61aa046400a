"""Every controller on every sequence, on the SDP models or on the full machine, measured as in appendix G."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.catalogue import (
    JointSetting,
    build_law,
    rig_setting,
    thesis_setting,
)
from hydrolek_drake.control.closed_loop import loop_on_model
from hydrolek_drake.control.comparison.metrics import (
    StepMeasures,
    mean_squared_error,
    spread,
    step_measures,
    switching,
    tool_error,
)
from hydrolek_drake.control.comparison.sequences import SetPoints, arm_and_number, sequence_data, set_points
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.control.names import check_names
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import wrist_position
from hydrolek_drake.rigs import Rig
from hydrolek_drake.station.step_sizes import StepSizes

MODEL_JOINTS = ("j1", "j2", "j3", "j4", "j4_linear")
"""Joint 4 twice, as in Tables G.1 and G.3: with the exponential law of Table 6.1, and with the linear one of 6.7."""

MACHINE_JOINTS = tuple(f"{arm}_j{number}" for arm in ("right", "left") for number in range(1, 6))
MACHINE_STEP_S = 1e-3
"""Step of the full machine's diagram in comparisons; at 2 ms the stops are not stable for every controller."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class JointMeasures:
    """What appendix G lists per joint.

    Attributes:
        step: of the first step; None for the sine.
        mse_deg2: mean squared error.
        output_variance: of the controller's output, in its unit.
        voltage_variance: [V^2].
        switching: variance of the differenced voltage [V^2], at the control sample.
    """

    step: StepMeasures | None
    mse_deg2: float
    output_variance: float
    voltage_variance: float
    switching: float


@dataclass(frozen=True)
class Trial:
    """One controller on one sequence.

    Attributes:
        controller: name in the catalogue.
        sequence: step, sine or grasp.
        joints: measures by joint.
        euclidean_mm: mean length of the end effector's error, by arm ("arm" on the models, "arm_linear"
            with the linear model of joint 4).
        tool_variance_mm2: variance of its components X, Y, Z, by arm.
        wrist_m: path of the wrist by arm, and where its set points lie, each of shape (n, 3), for plots.
        time_s: of the signals, for plots.
        set_point_deg: shape (n, joints).
        angle_deg: shape (n, joints).
        voltage_V: shape (n, joints).
    """

    controller: str
    sequence: str
    joints: dict[str, JointMeasures]
    euclidean_mm: dict[str, float]
    tool_variance_mm2: dict[str, tuple[float, ...]]
    wrist_m: dict[str, tuple[NDArray[np.floating], NDArray[np.floating]]] = field(repr=False)
    time_s: NDArray[np.floating] = field(repr=False)
    set_point_deg: NDArray[np.floating] = field(repr=False)
    angle_deg: NDArray[np.floating] = field(repr=False)
    voltage_V: NDArray[np.floating] = field(repr=False)


@dataclass
class Bench:
    """Results so far.

    Attributes:
        plant: "sdp" or "full".
        trials: in the order in which they were run.
        interrupted: whether the user stopped it.
        failed: trials whose simulation broke down, with the reason.
    """

    plant: str
    trials: list[Trial] = field(default_factory=list)
    interrupted: bool = False
    failed: list[str] = field(default_factory=list)

    def trial(self, controller: str, sequence: str) -> Trial | None:
        """One trial, or None."""
        for trial in self.trials:
            if (trial.controller, trial.sequence) == (controller, sequence):
                return trial
        return None


def bench_on_models(
    controllers: Sequence[str], sequences: Sequence[str], *, progress: Progress | None = None
) -> Bench:
    """Controllers on the SDP models of Tables 6.1 and 6.7, joints 1 to 4, as chapter 6 simulates them.

    Raises:
        InputError: unknown controller or sequence.
    """
    check_names(controllers)
    settings = {joint: thesis_setting(joint) for joint in MODEL_JOINTS}
    bench = Bench("sdp")
    try:
        for name in controllers:
            for sequence in sequences:
                points = set_points(sequence, MODEL_JOINTS, sample_s(), machine=False)
                if progress:
                    progress(f"{name}, {sequence}")
                bench.trials.append(_on_models(name, points, settings))
    except KeyboardInterrupt:
        bench.interrupted = True
    return bench


def _on_models(name: str, points: SetPoints, settings: dict[str, JointSetting]) -> Trial:
    columns = []
    for i, joint in enumerate(points.joints):
        setting = settings[joint]
        law = build_law(name, setting, noisy=False)
        columns.append(
            loop_on_model(
                law,
                setting.model,
                points.values_deg[:, i],
                sample_s(),
                initial_deg=float(points.start_deg[i]),
            )
        )
    ratio = round(sample_s() / (columns[0].time_s[1] - columns[0].time_s[0]))
    stacked = [
        np.column_stack([getattr(c, key) for c in columns]) for key in ("angle_deg", "voltage_V", "output")
    ]
    wanted = np.column_stack([c.set_point_deg for c in columns])
    return _measured(name, points, columns[0].time_s, wanted, *stacked, ratio=ratio)


def bench_on_machine(
    rig: Rig,
    controllers: Sequence[str],
    sequences: Sequence[str],
    *,
    seed: int,
    progress: Progress | None = None,
) -> Bench:
    """Controllers on the full machine: all joints of both arms that have a sensor, at once and coupled.

    Args:
        rig: with the joints of `MACHINE_JOINTS`, or some of them.
        controllers: names in the catalogue.
        sequences: of `sequences.NAMES`.
        seed: of the sensors' noise.
        progress: called before each trial.

    Raises:
        InputError: unknown controller or sequence, or a rig without such joints.
    """
    check_names(controllers)
    joints = [joint for joint in MACHINE_JOINTS if joint in rig.joints]
    if not joints:
        raise InputError(f"rig {rig.name} has none of the joints {', '.join(MACHINE_JOINTS)}")
    if progress:
        progress("step tests of every joint")
    settings = {joint: rig_setting(rig, joint) for joint in joints}
    bench = Bench("full")
    sizes = StepSizes(step=MACHINE_STEP_S, integrator="symplectic_euler", mount_forces=False)
    try:
        for name in controllers:
            for sequence in sequences:
                if progress:
                    progress(f"{name}, {sequence}")
                points = set_points(sequence, joints, sample_s(), machine=True)
                try:
                    signals = run_controlled(
                        rig,
                        {joint: build_law(name, settings[joint], noisy=True) for joint in joints},
                        points.values_deg,
                        sample_s(),
                        initial_deg=dict(zip(joints, map(float, points.start_deg), strict=True)),
                        noise=np.random.default_rng(seed),
                        sizes=sizes,
                    )
                except RuntimeError as reason:  # Drake's: a state has left all bounds
                    bench.failed.append(f"{name}, {sequence}: {str(reason).splitlines()[0]}")
                    continue
                bench.trials.append(
                    _measured(
                        name,
                        points,
                        signals.time_s,
                        signals.set_point_deg,
                        signals.angle_deg,
                        signals.voltage_V,
                        signals.output,
                        ratio=1,
                    )
                )
    except KeyboardInterrupt:
        bench.interrupted = True
    return bench


def _measured(
    name: str,
    points: SetPoints,
    time: NDArray[np.floating],
    wanted: NDArray[np.floating],
    angle: NDArray[np.floating],
    voltage: NDArray[np.floating],
    output: NDArray[np.floating],
    *,
    ratio: int,
) -> Trial:
    """Measures of one trial; `ratio` rows of signals belong to a control sample."""
    steady = sequence_data()["steady"]
    by_joint = {}
    first = slice(points.first_step.start * ratio, points.first_step.stop * ratio)
    for i, joint in enumerate(points.joints):
        step = None
        target = float(points.values_deg[0, i])
        if first.stop > first.start and target != points.start_deg[i]:
            step = step_measures(
                time[first],
                angle[first, i],
                float(points.start_deg[i]),
                target,
                last_s=float(steady["last"]["value"]),
                still_deg=float(steady["still"]["value"]),
            )
        by_joint[joint] = JointMeasures(
            step,
            mean_squared_error(wanted[:, i], angle[:, i]),
            spread(output[::ratio, i]),
            spread(voltage[::ratio, i]),
            switching(voltage[::ratio, i]),
        )
    euclidean, variance, wrist = {}, {}, {}
    for arm, columns in _arms(points.joints).items():
        reached, asked = _wrist(angle, columns), _wrist(wanted, columns)
        length, parts = tool_error(asked, reached)
        euclidean[arm], variance[arm] = length, tuple(map(float, parts))
        wrist[arm] = (reached[::ratio], asked[::ratio])
    return Trial(
        name, points.name, by_joint, euclidean, variance, wrist, time[::ratio], wanted[::ratio], angle[::ratio],
        voltage[::ratio],
    )  # fmt: skip


def _arms(joints: Sequence[str]) -> dict[str, list[tuple[int, int]]]:
    """Arm -> pairs of column and joint index 0 to 5; a joint with two models makes two arms of it."""
    arms: dict[str, list[tuple[int, int]]] = {}
    for column, joint in enumerate(joints):
        arm, number = arm_and_number(joint)
        if not joint.endswith("_linear"):
            arms.setdefault(arm or "arm", []).append((column, int(number[1:]) - 1))
    for column, joint in enumerate(joints):
        if joint.endswith("_linear"):
            index = int(arm_and_number(joint)[1][1:]) - 1
            arms["arm_linear"] = [pair for pair in arms.get("arm", []) if pair[1] != index] + [
                (column, index)
            ]
    return arms


def _wrist(angle_deg: NDArray[np.floating], columns: list[tuple[int, int]]) -> NDArray[np.floating]:
    """Wrist positions [m]; joints that are not controlled stand at zero."""
    angles = np.zeros((len(angle_deg), 6))
    for column, index in columns:
        angles[:, index] = np.radians(angle_deg[:, column])
    return wrist_position(angles)
