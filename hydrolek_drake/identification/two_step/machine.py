"""A simulated machine that differs from its rig, and recordings of it under a set-point sequence (section 4.7)."""

from pathlib import Path

import numpy as np

from hydrolek_drake.control.closed_loop import loop_on_rollout
from hydrolek_drake.control.designed import design_controller
from hydrolek_drake.control.models.rig_model import rig_model
from hydrolek_drake.control.thesis_gains import entry, sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.two_step.settings import MASSES, only_joint, two_step_data
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig

PARTS = ("estimation", "validation")


def other_machine(rig: Rig, rng: np.random.Generator) -> Rig:
    """A machine of the rig's build: masses by one factor, frictions and all with a range by their own."""
    joint = only_joint(rig)
    data = two_step_data()["machine"]
    spread, friction = (float(data[name]["value"]) for name in ("spread", "friction_spread"))

    def factor(within: float) -> float:
        return float(np.exp(rng.uniform(-1.0, 1.0) * np.log1p(within)))

    heavier = factor(spread)
    values = {f"joints.{joint}.load.{name}": heavier * rig.value(f"load.{name}") for name in MASSES}
    damping = f"joints.{joint}.load.damping"
    values[damping] = factor(friction) * rig.value(damping)
    for path in [*rig.free_parameters(), f"joints.{joint}.solenoid.gap_constant"]:
        if path not in values:
            within = friction if path.endswith("viscous_friction") else spread
            values[path] = factor(within) * rig.value(path)
    return rig.with_values(values)


def set_points_deg(rig: Rig, part: str) -> np.ndarray:
    """One set point per control sample, over the whole range of the joint. # (n,)."""
    data = two_step_data()["sequence"]
    low, high = (rig.value(f"load.{name}") for name in ("lower_stop", "upper_stop"))
    count = round(float(data["hold"]["value"]) / sample_s())
    levels = np.degrees(low + (high - low) * np.array([data["start"], *data[part]], dtype=float))
    return np.repeat(levels, count)


def record_sequence(machine: Rig, controlled_as: Rig, part: str, rng: np.random.Generator) -> Recording:
    """Follow a set-point sequence and record command and angle.

    The controller is one with PIP and inverse dead-zone, designed for the rig and not for the machine.

    Args:
        machine: what moves.
        controlled_as: what the controller was designed for.
        part: "estimation" or "validation".
        rng: draws the noise of the sensor.

    Raises:
        InputError: the loop diverges.
    """
    joint = only_joint(machine)
    first, second, third = map(float, entry("pip_idz.c", "j2")["weights"])
    law = design_controller(rig_model(controlled_as, joint), weights=(first, second, third)).law(noisy=True)
    record = machine.records()
    sigma, grain = (np.degrees(float(record["sensor"][name][0])) for name in ("noise", "resolution"))

    def read(angle: float) -> float:
        noisy = angle + sigma * float(rng.standard_normal())
        return round(noisy / grain) * grain if grain > 0.0 else noisy

    wanted = set_points_deg(machine, part)
    signals = loop_on_rollout(
        law,
        record,
        wanted,
        sample_s(),
        rows_per_sample=int(two_step_data()["sequence"]["rows"]["value"]),
        longest_step=machine.value("integration.longest_step"),
        initial_deg=float(wanted[0]),
        noise=read,
    )
    if not np.isfinite(signals.angle_deg).all():
        raise InputError(f"rig {machine.name}: the closed loop diverged; the machine cannot be recorded")
    return Recording(
        f"{joint}_{part}",
        signals.time_s,
        {
            f"{joint}.command": signals.voltage_V,
            f"{joint}.angle": np.radians([read(float(a)) for a in signals.angle_deg]),
            f"{joint}.reference": np.radians(signals.set_point_deg),
        },
        Path(f"{joint}_{part}.csv"),
    )
