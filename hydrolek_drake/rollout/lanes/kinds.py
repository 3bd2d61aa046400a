"""Which machines a compiled loop over lanes does for: what is a constant in it, and what a number of each lane."""

import math
from functools import cache

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.physics.driven import DRIVEN
from hydrolek_drake.physics.law import MOST_TERMS
from hydrolek_drake.physics.records import STAGES, flat, position_of
from hydrolek_drake.physics.solenoid import steps_needed
from hydrolek_drake.rollout.drive import acts_early
from hydrolek_drake.rollout.lanes.view import Kind

GROUPS = (("rod_friction", "rod_damping", "load_friction"),)
"""Hooks whose effects take time in every step. A loop over lanes is compiled with a group or without it. What enters at
other hooks is a number that may be zero: all of them together make a step of eight machines a fifth slower, and each
kind that is not compiled costs 10 s, or has its machines rolled out one by one, which takes three times as long."""

SOMETIMES = (
    "command.ramp",
    "amplifier.coil_time",
    "valve.flow_force",
    "cylinder.stop_stiffness",
    "cylinder.column_compliance",
    "cylinder.bristle_deflection",
)
"""Parameters of the stages that most machines have at zero, and that cost as much."""

_Places = tuple[tuple[int, float], ...]

TERMS = (1, 2, MOST_TERMS)
"""Numbers of a law's terms for which loops are compiled; a law in between gets terms of no size."""


def kind_of(joint: np.ndarray, spool_steps: int, law: np.ndarray | None = None, probed: bool = False) -> Kind:
    """What of a machine is known when a loop over lanes is compiled.

    Args:
        joint: its record, shape (1,).
        spool_steps: as of `roll_out`.
        law: how inputs from outside follow from the state, rows of `law.LAW`, or None.
        probed: whether there are other inputs from outside.
    """
    numbers = flat(joint)[0]
    variants, groups, sometimes = _places()
    known = {place: float(numbers[place]) for place in variants}
    for sizes, places in groups:
        if all(numbers[size] == neutral for size, neutral in sizes):
            known |= {place: float(neutral) for place, neutral in places}
    known |= {place: 0.0 for place in sometimes if not numbers[place] > 0.0}
    known |= dict.fromkeys(
        np.flatnonzero(np.isnan(numbers)).tolist(), math.nan
    )  # of variants that it has not
    steps = int(_steps_in(spool_steps, joint))
    if law is None:
        return _kind(tuple(sorted(known.items())), steps, 0, False, probed)
    terms = next(count for count in TERMS if count >= len(law))
    # that a law acts early costs a fifth of a step, and is taken for granted where another kind would be compiled; with
    # inputs from outside commands are rounded otherwise then
    early = bool(acts_early(law, joint[0])) if probed else True
    return _kind(tuple(sorted(known.items())), steps, terms, early, probed)


@njit
def _steps_in(spool_steps: int, joints: np.ndarray) -> int:
    """Steps of the spool of the first of some joints: an array is handed over faster than a record."""
    return steps_needed(spool_steps, joints[0])


@cache
def _kind(known: _Places, steps: int, terms: int, early: bool, probed: bool) -> Kind:
    """The one kind of which so much is known."""
    return Kind(known, steps, terms, early, probed)


@cache
def _places() -> tuple[tuple[int, ...], tuple[tuple[_Places, _Places], ...], tuple[int, ...]]:
    """Places in a flat record: what is always known; of each group sizes, and all numbers, with neutral values; others.

    Always known are variants, and what a recording drives.
    """
    variants = tuple(position_of(stage, "variant") for stage in STAGES)
    variants += tuple(position_of("driven", name) for name in DRIVEN.names or ())
    groups = []
    for hooks in GROUPS:
        effects = [effect for effect in EFFECTS.values() if any(hook in effect.hooks for hook in hooks)]
        sizes = tuple((position_of(e.key, e.size), e.neutral_size) for e in effects)
        numbers = tuple(
            (position_of(e.key, p.name), float(p.neutral or 0.0)) for e in effects for p in e.parameters
        )
        groups.append((sizes, numbers))
    sometimes = tuple(position_of(*path.split(".")) for path in SOMETIMES)
    return variants, tuple(groups), sometimes
