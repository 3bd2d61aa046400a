"""Machines, commands and laws that the tests of lanes share."""

import json
import sys
from pathlib import Path

import numpy as np

from hydrolek_drake.physics.law import LAW, OTHERS, PLACES, SPEEDS, TIMES
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.physics.records import flat, position_of
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.run import Run

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from two_executions.cases import SIZES as SIZES_FILE
from two_executions.cases import with_effect  # of docs/evidence/agreement.md

__all__ = ("SIZES", "STEP", "assert_alike", "drawn_law", "driven", "in_lanes", "varied", "with_effect")

SIZES = json.loads(SIZES_FILE.read_text())
STEP = 5e-4


def driven(seconds, seed=3):
    times = np.arange(0.0, seconds, 0.01)
    levels = np.random.default_rng(seed).uniform(-4.0, 4.0, size=times.size // 23 + 1)
    return times, np.repeat(levels, 23)[: times.size]


def varied(record, rng, count):
    """Machines whose numbers, delays among them, are 2 % off."""
    records = np.repeat(record, count)
    names = ("supply.pressure", "fluid.bulk_modulus", "command.delay", "load.inertia", "valve.discharge")
    for name in names:
        flat(records)[:, position_of(*name.split("."))] *= rng.uniform(0.98, 1.02, size=count)
    return records


def assert_alike(done, alone):
    """To the last bit."""
    assert done.diverged == alone.diverged
    for name in SIGNALS:
        np.testing.assert_array_equal(getattr(done.signals, name), getattr(alone.signals, name), err_msg=name)
    if done.diverged is None:
        np.testing.assert_array_equal(done.state, alone.state)


def in_lanes(records, times, volts, **named):
    """Machines under one command."""
    return roll_out_lanes(Run(records[:1], times, volts, times, **named).of(records), at_once=True)


def drawn_law(rng, terms):
    """Terms of all kinds, drawn; what divides is of the size of what it divides."""
    law = np.zeros(terms, dtype=LAW)
    places = {"probe": PROBES, "time": TIMES, "place": PLACES, "speed_shape": SPEEDS, "other": OTHERS}
    for name, choices in places.items():
        law[name] = rng.integers(0, len(choices), size=terms)
    for name, value in (
        ("seconds", 5.0),
        ("low", -0.1),
        ("high", 0.7),
        ("centre", 0.2),
        ("reach", 0.3),
        ("speed", 0.5),
        ("slow", 0.01),
        ("opening", 1e-3),
        ("pressure", 1e7),
    ):
        law[name] = value
    scales = {"command": 0.3, "supply": 1e5, "cylinder": 200.0, "load": 40.0, "flow": 1e-5, "sensor": 1e-3}
    scales |= {"capacity_a": 1e-13, "capacity_b": 1e-13, "ramp": 1e-3, "coil_time": 1e-3}
    sizes = np.array([scales.get(PROBES[int(probe)], 0.05) for probe in law["probe"]])
    law["sine"], law["cosine"] = sizes * rng.uniform(-1.0, 1.0, size=(2, terms))
    law["frequency"] = rng.choice([0.0, 0.0, 1.3], size=terms)
    law["at_rod"] = rng.integers(0, 2, size=terms)
    return law
