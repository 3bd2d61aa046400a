"""Commands for foreign machines."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from hydrolek_drake.challenge.foreign.building import places, start_of
from hydrolek_drake.challenge.foreign.equations import SAMPLE_S, STEP_S, Closed, Played, played
from hydrolek_drake.challenge.foreign.plant import Plant


def driven(
    own: Mapping[str, Any],
    kind: str,
    plant: Plant,
    drive: str,
    seconds: float,
    rng: np.random.Generator,
    noise: float,
    step: float = STEP_S,
) -> Played:
    """A machine under commands that are drawn.

    Args:
        own: of `machines.yaml`.
        kind: of machine.
        plant: the machine.
        drive: open or closed.
        seconds: how long.
        rng: of commands, and of the noise that a controller sees.
        noise: standard deviation of that [rad or m].
        step: of the integration [s].
    """
    how, base = own["driving"], own["kinds"][kind]
    start = start_of(base)
    ends = places(plant, (0.0, 1.0))
    span = ends[1] - ends[0]
    count = round(seconds / SAMPLE_S)
    closed = drive == "closed"
    series = [start if closed else 0.0] * 50
    while len(series) < count:
        least, most = how["set_points_last_s" if closed else "holds_s"]
        last = round(rng.uniform(least, most) / SAMPLE_S)
        if closed:
            value = float(places(plant, (rng.uniform(*how["set_points"]),))[0])
        else:
            rests = rng.random() < how["rests"]
            value = 0.0 if rests else how["share_of_full"] * plant.full_volts * float(rng.uniform(-1.0, 1.0))
        series += [value] * last
    low, high = places(plant, how["turned_back_at"])
    jump = plant.overlap / plant.travel * plant.full_volts
    driver = Closed(
        how["gain_V_per_stroke"] / span if closed else 0.0,
        how["tolerance_of_stroke"] * span,
        jump,
        low,
        high,
    )
    seen = noise * rng.standard_normal(count)
    return played(plant, np.array(series[:count]), start, driver, seen, step)
