"""Results of a comparison as rows of text, beside the thesis's where it prints them."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isnan

from hydrolek_drake.control.catalogue import CONTROLLERS
from hydrolek_drake.control.comparison.bench import Bench, JointMeasures
from hydrolek_drake.control.comparison.thesis_tables import printed


@dataclass(frozen=True)
class Measure:
    """A row of appendix G.

    Attributes:
        key: in the thesis's tables and in `report.json`.
        title: with unit.
        value: from a joint's measures.
        digits: after the point.
        sequences: where it is told.
    """

    key: str
    title: str
    value: Callable[[JointMeasures], float]
    digits: int
    sequences: tuple[str, ...]


def _of_step(name: str) -> Callable[[JointMeasures], float]:
    return lambda m: float("nan") if m.step is None else float(getattr(m.step, name))


MEASURES = (
    Measure("rise_s", "rise time [s]", _of_step("rise_s"), 3, ("step", "grasp")),
    Measure("overshoot_percent", "overshoot [%]", _of_step("overshoot_percent"), 1, ("step", "grasp")),
    Measure("error_deg", "steady-state error [deg]", _of_step("error_deg"), 2, ("step", "grasp")),
    Measure("mse_deg2", "mean squared error [deg²]", lambda m: m.mse_deg2, 1, ("step", "sine", "grasp")),
    Measure(
        "output_variance",
        "variance of the controller's output",
        lambda m: m.output_variance,
        3,
        ("step", "sine", "grasp"),
    ),
    Measure(
        "voltage_variance", "variance of the voltage [V²]", lambda m: m.voltage_variance, 3,
        ("step", "sine", "grasp"),
    ),
    Measure(
        "switching", "variance of the differenced voltage [V²]", lambda m: m.switching, 4,
        ("step", "sine", "grasp"),
    ),
)  # fmt: skip


def text(value: float, digits: int) -> str:
    """A number, or "na" for none: the joint has not come to rest, or never reached 90 %."""
    return "na" if isnan(value) else f"{value:.{digits}f}"


def beside(plant: str, sequence: str, controller: str, measure: Measure, joint: str) -> str:
    """What the thesis prints, in brackets with a space before; empty where it prints nothing.

    On the full machine joint 4 may have been measured with the controller for the linear model, too or only.
    """
    theirs = text(printed(plant, sequence, controller, measure.key, joint), measure.digits)
    linear = "na"
    if plant == "full":
        linear = text(printed(plant, sequence, controller, measure.key, f"{joint}_linear"), measure.digits)
    said = [part for part in (theirs, f"linear {linear}") if not part.endswith("na")]
    return f" ({'; '.join(said)})" if said else ""


def rows(bench: Bench, sequence: str, measure: Measure) -> tuple[list[str], list[list[str]]]:
    """Header and one row per controller: ours, and the thesis's in brackets."""
    trials = [trial for trial in bench.trials if trial.sequence == sequence]
    if not trials:
        return [], []
    joints = list(trials[0].joints)
    body = []
    for trial in trials:
        cells = [CONTROLLERS[trial.controller][0]]
        for joint in joints:
            cell = text(measure.value(trial.joints[joint]), measure.digits)
            cells.append(cell + beside(bench.plant, sequence, trial.controller, measure, joint))
        body.append(cells)
    return ["controller", *(joint.replace("_", " ") for joint in joints)], body


def tool_rows(bench: Bench, sequence: str) -> tuple[list[str], list[list[str]]]:
    """Mean length of the end effector's error and its variances, one row per controller."""
    trials = [trial for trial in bench.trials if trial.sequence == sequence]
    if not trials:
        return [], []
    arms = list(trials[0].euclidean_mm)
    body = []
    for trial in trials:
        cells = [CONTROLLERS[trial.controller][0]]
        for arm in arms:
            cell = text(trial.euclidean_mm[arm], 1)
            key = "euclidean_linear_mm" if arm == "arm_linear" else "euclidean_mm"
            theirs = printed(bench.plant, sequence, trial.controller, key, arm)
            if not isnan(theirs):
                cell += f" ({text(theirs, 1)})"
            cells += [cell, " ".join(f"{value:.0f}" for value in trial.tool_variance_mm2[arm])]
        body.append(cells)
    head = ["controller"]
    for arm in arms:
        head += [f"{arm}: mean error [mm]", "variance X Y Z [mm²]"]
    return head, body


@dataclass(frozen=True)
class Ranked:
    """How a controller meets the objectives of chapter 6 on all joints.

    Attributes:
        controller: name.
        met: joints that meet all three objectives.
        joints: how many there are.
        worst: largest rise time [s], overshoot [%] and steady-state error [deg]; infinite where not reached.
        switching: mean over the joints [V^2].
        mse: mean over the joints [deg^2].
    """

    controller: str
    met: int
    joints: int
    worst: tuple[float, float, float]
    switching: float
    mse: float


RISE_S, OVERSHOOT_PERCENT, ERROR_DEG = 2.0, 10.0, 0.5
"""Design objectives of chapter 6."""


def ranking(bench: Bench, sequence: str = "step") -> list[Ranked]:
    """Controllers by joints that meet the objectives, then by the mean squared error; each joint once."""
    ranked = []
    for trial in bench.trials:
        if trial.sequence != sequence:
            continue
        joints = {joint: m for joint, m in trial.joints.items() if not joint.endswith("_linear")}
        triples = [_triple(m) for m in joints.values() if m.step is not None]
        met = sum(r < RISE_S and o < OVERSHOOT_PERCENT and e < ERROR_DEG for r, o, e in triples)
        count = len(joints)
        ranked.append(
            Ranked(
                trial.controller,
                met,
                len(triples),
                (max(t[0] for t in triples), max(t[1] for t in triples), max(t[2] for t in triples)),
                sum(m.switching for m in joints.values()) / count,
                sum(m.mse_deg2 for m in joints.values()) / count,
            )
        )
    return sorted(ranked, key=lambda r: (-r.met, r.mse))


def _triple(measures: JointMeasures) -> tuple[float, float, float]:
    step = measures.step
    assert step is not None
    values = (step.rise_s, step.overshoot_percent, step.error_deg)
    rise, overshoot, error = (float("inf") if isnan(value) else value for value in values)
    return rise, overshoot, error


def ranking_rows(bench: Bench) -> tuple[list[str], list[list[str]]]:
    """The ranking as text."""
    head = [
        "controller", "joints that meet all three", "worst rise [s]", "worst overshoot [%]", "worst error [deg]",
        "mean switching [V²]", "mean squared error [deg²]",
    ]  # fmt: skip
    body = []
    for r in ranking(bench):
        worst = ["na" if value == float("inf") else f"{value:.2f}" for value in r.worst]
        body.append(
            [
                CONTROLLERS[r.controller][0],
                f"{r.met} of {r.joints}",
                *worst,
                f"{r.switching:.4f}",
                f"{r.mse:.1f}",
            ]
        )
    return head, body


def sentence(bench: Bench) -> str:
    """What came out, in one line."""
    ranked = ranking(bench)
    plant = (
        "the SDP models of joints 1 to 4" if bench.plant == "sdp" else "the full machine, all joints at once"
    )
    if not ranked:
        return f"On {plant} no step was run."
    best = ranked[0]
    full = [CONTROLLERS[r.controller][0] for r in ranked if r.met == r.joints]
    said = (
        f"on every joint by {', '.join(full)}"
        if full
        else f"on every joint by none; most by {CONTROLLERS[best.controller][0]} ({best.met} of {best.joints})"
    )
    return (
        f"On {plant}, rise time under {RISE_S:g} s, overshoot under {OVERSHOOT_PERCENT:g} % and steady-state error "
        f"under {ERROR_DEG:g} deg are met {said}."
    )
