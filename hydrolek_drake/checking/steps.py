"""Whether a rollout's steps are short enough for a machine: the same in finer ones."""

import numpy as np

from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout import roll_out

SHARE_OF_TRAVEL = 5e-4
"""A reading may differ by this share of the travel, a good sensor's linearity, or by its noise if that is more."""

SHARE_OF_PRESSURE = 5e-3
"""The same of the pressures, of the supply: a transducer of class 0.5."""

FINER = 4.0
"""By so much the steps are finer with which others are compared: of second order, they err a sixteenth as much."""

TRIED = (1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01)
"""Shares of a rig's own step that are tried until one agrees."""

SECONDS, EVERY, LEVEL = 3.0, 0.01, 0.6
"""The machine is driven so long with levels, each for a few tenths of a second, up to this share of its limit."""


def driven_about(limit: float, neutral: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and a command [V] with which a machine moves at all speeds and reverses."""
    times = np.arange(0.0, SECONDS, EVERY)
    generator = np.random.default_rng(0)
    levels = generator.uniform(-LEVEL * limit, LEVEL * limit, size=times.size // 25 + 1)
    return times, neutral + np.repeat(levels, 25)[: times.size]


def differs(
    rig: Rig, joint: str, times: np.ndarray, volts: np.ndarray, step: float, noise: float = 0.0
) -> float | None:
    """By how much a rollout differs from one in finer steps, rms, in multiples of what may be; None if it diverges.

    Args:
        rig: the machine.
        joint: that is driven, alone.
        times: of command and signals [s].
        volts: the command [V].
        step: that is asked about [s].
        noise: of the measured position [rad or m]; the rig's own if 0.
    """
    i = rig.joints.index(joint)
    record = rig.records()[i : i + 1]
    coarse, fine = (
        roll_out(
            record,
            times,
            volts,
            times,
            longest_step=h,
            spool_steps=round(rig.value("integration.spool_steps")),
        )
        for h in (step, step / FINER)
    )
    if coarse.diverged or fine.diverged:
        return None
    travel = float(np.ptp(fine.signals.reading))
    allowed = max(
        noise or float(record["sensor"]["noise"][0]), SHARE_OF_TRAVEL * travel, np.finfo(float).tiny
    )
    worst = _rms(coarse.signals.reading - fine.signals.reading) / allowed
    supply = float(np.max(np.abs(fine.signals.supply_pressure)))
    if supply > 0.0:
        for name in ("pressure_a", "pressure_b"):
            off = _rms(getattr(coarse.signals, name) - getattr(fine.signals, name))
            worst = max(worst, off / (SHARE_OF_PRESSURE * supply))
    return worst


def step_that_agrees(rig: Rig, joint: str) -> float | None:
    """The longest of `TRIED` with which a machine that is driven about moves as in finer steps [s]; None for none."""
    own = rig.value("integration.longest_step")
    times, volts = driven_about(
        *(rig.value(f"joints.{joint}.command.{name}") for name in ("limit", "neutral"))
    )
    for share in TRIED:
        found = differs(rig, joint, times, volts, share * own)
        if found is not None and found <= 1.0:
            return share * own
    return None


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
