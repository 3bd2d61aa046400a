"""30 deg steps on changed machines: what the aim of better control than the thesis's is judged by."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.closed_loop import LoopSignals, loop_on_rollout
from hydrolek_drake.control.comparison.conditions import Condition, conditions_data, machine, span_deg
from hydrolek_drake.control.comparison.metrics import step_measures, switching
from hydrolek_drake.control.laws.law import Array, ControlLaw, WithoutState
from hydrolek_drake.control.thesis_gains import sample_s, voltage_limit_V

ROWS = 5
"""Rows of signals in a control sample."""

OVERSHOOT_PERCENT, ERROR_DEG, RISE_SHARE = 2.0, 0.1, 1.15
"""The aim: overshoot, steady-state error, and rise time against that of full voltage."""


@dataclass(frozen=True)
class FullVoltage(WithoutState):
    """Full voltage in one direction: what the joint's saturation rate allows.

    Attributes:
        voltage_V: with sign.
    """

    voltage_V: float

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`."""
        return state, self.voltage_V, self.voltage_V


@dataclass(frozen=True)
class Case:
    """One step on one machine.

    Attributes:
        joint: "right_j1" ...
        condition: of the machine.
        record: its parameters, shape (1,).
        begin_deg: where the joint rests.
        end_deg: set point.
        possible_s: rise time at full voltage.
        longest_step: of the rollout [s].
    """

    joint: str
    condition: Condition
    record: np.ndarray
    begin_deg: float
    end_deg: float
    possible_s: float
    longest_step: float


@dataclass(frozen=True)
class Verdict:
    """How one case was answered.

    Attributes:
        case: which.
        rise_s: NaN if 90 % was never reached.
        overshoot_percent: of the step.
        error_deg: size of the mean error in the last two seconds.
        largest_deg: largest error there.
        switching: variance of the differenced voltage [V^2].
    """

    case: Case
    rise_s: float
    overshoot_percent: float
    error_deg: float
    largest_deg: float
    switching: float

    @property
    def meets_objectives(self) -> bool:
        """Objectives of chapter 6."""
        return self.rise_s < 2.0 and self.overshoot_percent < 10.0 and self.error_deg < 0.5

    @property
    def rise_share(self) -> float:
        """Rise time over that of full voltage."""
        return self.rise_s / self.case.possible_s

    @property
    def meets_aim(self) -> bool:
        """Near the saturation rate, hardly any overshoot, within 0.1 deg."""
        return (
            self.rise_share < RISE_SHARE
            and self.overshoot_percent < OVERSHOOT_PERCENT
            and self.error_deg < ERROR_DEG
        )


def make_cases(
    joints: Sequence[str],
    conditions: Iterable[Condition],
    longest_step: float,
    generator: np.random.Generator | None = None,
) -> list[Case]:
    """Steps in both directions, each joint under each condition.

    Args:
        joints: "right_j1" ...
        conditions: of the machines.
        longest_step: of the rollout [s].
        generator: draws random deviations of each machine; None for none.
    """
    cases = []
    for joint in joints:
        low, high = span_deg(joint)
        for condition in conditions:
            record = machine(joint, condition, generator)
            for begin, end in ((low, high), (high, low)):
                signals = _loop(
                    FullVoltage(float(np.copysign(voltage_limit_V(), end - begin))),
                    record, np.full(_samples("fastest"), end), begin, longest_step, None,
                )  # fmt: skip
                possible = step_measures(
                    signals.time_s, signals.angle_deg, begin, end, last_s=sample_s(), still_deg=np.inf
                ).rise_s
                cases.append(Case(joint, condition, record, begin, end, possible, longest_step))
    return cases


def judge(law: ControlLaw, case: Case, seed: int, *, learned: bool = False) -> Verdict:
    """Answer one step with sensor noise.

    Args:
        law: for the case's joint; it starts with nothing learned.
        case: machine and step.
        seed: of the noise.
        learned: judge the step after one there and back, when what can be learned has been.
    """
    count = _samples("judged")
    wanted = np.full(count, case.end_deg)
    if learned:
        wanted = np.concatenate([wanted, np.full(count, case.begin_deg), wanted])
    signals = _loop(law, case.record, wanted, case.begin_deg, case.longest_step, np.random.default_rng(seed))
    last = slice(len(signals.time_s) - count * ROWS, None)
    time, angle = signals.time_s[last] - signals.time_s[last][0], signals.angle_deg[last]
    measures = step_measures(
        time, angle, case.begin_deg, case.end_deg, last_s=time[-1] / 3.0, still_deg=np.inf
    )
    tail = np.abs(angle[time >= time[-1] * 2.0 / 3.0] - case.end_deg)
    return Verdict(
        case,
        measures.rise_s,
        measures.overshoot_percent,
        measures.error_deg,
        float(np.max(tail)),
        switching(signals.voltage_V[last][::ROWS]),
    )


def judge_all(
    law_for: Callable[[str], ControlLaw], cases: Sequence[Case], seed: int, *, learned: bool = False
) -> list[Verdict]:
    """Verdicts in the order of the cases; each case has noise of its own."""
    return [judge(law_for(case.joint), case, seed + i, learned=learned) for i, case in enumerate(cases)]


def _samples(what: str) -> int:
    return round(float(conditions_data()["duration"][what]["value"]) / sample_s())


def _loop(
    law: ControlLaw,
    record: np.ndarray,
    wanted: Array,
    begin_deg: float,
    longest_step: float,
    generator: np.random.Generator | None,
) -> LoopSignals:
    noise = None
    if generator is not None:
        sigma = float(np.degrees(record["sensor"]["noise"][0]))
        grain = float(np.degrees(record["sensor"]["resolution"][0]))

        def noise(angle: float) -> float:
            noisy = angle + sigma * float(generator.standard_normal())
            return round(noisy / grain) * grain if grain > 0.0 else noisy

    return loop_on_rollout(
        law, record, wanted, sample_s(), rows_per_sample=ROWS, longest_step=longest_step,
        initial_deg=begin_deg, noise=noise,
    )  # fmt: skip
