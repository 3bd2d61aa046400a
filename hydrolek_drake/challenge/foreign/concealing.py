"""What foreign machines conceal, and how large it is."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from hydrolek_drake.challenge.foreign.building import noises, start_of
from hydrolek_drake.challenge.foreign.driving import driven
from hydrolek_drake.challenge.foreign.equations import played, reach
from hydrolek_drake.challenge.foreign.plant import Plant

SIZING_STEP_S = 4e-5
TRIES = 8
CLOSE = 0.75
"""An effect shows as much as was drawn, to within this factor."""
FARTHEST = 5.0
"""Sizes change by so much from one try to the next."""
WITHIN = 4.4
"""A dead time up to so many times a machine's own may be what its data sheet, wrong by a factor of two, is taken for:
a number of the nominal model, and nothing that it lacks."""
LARGEST = 30.0
"""A concealed effect is at most so many times, and at least this part of, its nominal size."""


def can_have(base: Mapping[str, Any], effect: str) -> bool:
    """Whether a machine can have an effect."""
    if effect == "load.payload":
        return bool(base["moves"] == "link" and not base["upright"])
    if effect == "supply.pressure_droop":
        return bool(base["supply"] == "constant")
    return bool(effect != "supply.pump_loss" or base["supply"] == "pump")


def sized(
    own: Mapping[str, Any],
    base: Mapping[str, Any],
    plant: Plant,
    effect: str,
    drive: str,
    seconds: float,
    pressures: bool,
    seed: int,
    rng: np.random.Generator,
) -> tuple[dict[str, float], float] | None:
    """Fields of an effect that shows as much as is drawn, and how much; None where no size in reach does.

    Args:
        own: of `machines.yaml`.
        base: numbers of the machine.
        plant: the machine that lacks nothing.
        effect: that it gets.
        drive: open or closed.
        seconds: how long it is driven.
        pressures: whether they are recorded.
        seed: of the commands.
        rng: of the size.
    """
    low, high = own["shows"]
    wanted = float(np.exp(rng.uniform(math.log(low), math.log(high))))
    when = float(rng.uniform(*own["payload_taken_s"]))
    turns = base["moves"] == "link"
    noise, pressure_noise = noises(own, turns)

    def shown(scale: float) -> float:
        own_rng = np.random.default_rng(seed)
        diseased = plant._replace(**_fields(own, base, plant, effect, scale, when))
        done = driven(own, base["kind"], diseased, drive, seconds, own_rng, noise, SIZING_STEP_S)
        sound = played(plant, done.volts, start_of(base), step=SIZING_STEP_S)
        parts = [np.mean(((done.reading - sound.reading) / noise) ** 2)]
        if pressures:
            for side in ("pressure_a", "pressure_b"):
                parts.append(np.mean(((getattr(done, side) - getattr(sound, side)) / pressure_noise) ** 2))
        return float(np.sqrt(np.mean(parts)))

    scale = 1.0
    for _ in range(TRIES):
        found = shown(scale)
        # a smaller loss would be within what a pump's displacement is known to
        enough = effect == "supply.pump_loss" and found > low
        if effect == "command.delay":
            late = _fields(own, base, plant, effect, scale, when)["late_s"]
            if plant.delay + late <= WITHIN * plant.delay:
                scale *= FARTHEST
                continue
            enough = found > low
        if enough or CLOSE * wanted < found < wanted / CLOSE:
            return _fields(own, base, plant, effect, scale, when), found
        by = wanted / found if math.isfinite(found) and found > 0.0 else 1.0 / FARTHEST
        scale *= min(max(by, 1.0 / FARTHEST), FARTHEST)
        if not 1.0 / LARGEST < scale < LARGEST:
            return None
    return None


def _fields(
    own: Mapping[str, Any], base: Mapping[str, Any], plant: Plant, effect: str, scale: float, when: float
) -> dict[str, Any]:
    """Fields of `Plant` for an effect of so many times its nominal size."""
    nominal = {key: scale * value for key, value in own["effects"][effect].items()}
    force = plant.area_a * plant.setting
    flow = base["rated_flow_l_min"][0] / 6e4
    lever = reach(plant, start_of(base))[1]
    unit = {
        "leak": flow / plant.setting,
        "coulomb": force,
        "static": force,
        "late_s": 1.0,
        "droop": plant.setting / flow,
        "lost": 1.0,
        "air": 1.0,
        "gap": plant.stroke / lever,
        "payload": base["mass_kg"],
        "shift": plant.travel,
        "null_leak": flow / plant.setting,
        "drift": plant.stroke / lever / 60.0,
    }
    found = {key: float(value * unit[key]) for key, value in nominal.items()}
    if "lost" in found:
        found["lost"] = min(found["lost"], 0.95)
    if "payload" in found:
        found["payload_s"] = when
    return found
