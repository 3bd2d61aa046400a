"""The parameter record of one joint: one field per stage, one per effect, one per term of a law, and what drives it.

All numbers are float64, so a record is also a flat vector (`flat`), which is how parameters are fitted and
how they are stored in a Drake context.
"""

import numpy as np

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.physics import (
    amplifier,
    base,
    command,
    cylinder,
    fluid,
    linkage,
    load,
    sensor,
    solenoid,
    supply,
)
from hydrolek_drake.physics.driven import DRIVEN, is_driven
from hydrolek_drake.physics.law import LAW_RECORD
from hydrolek_drake.physics.lines import accumulator, hose
from hydrolek_drake.physics.parameters import Stage
from hydrolek_drake.physics.usual import MARK, RARE, RARE_NUMBERS
from hydrolek_drake.physics.valves import load_holding
from hydrolek_drake.physics.valves import variants as valve

SHARED_STAGES: dict[str, Stage] = {s.STAGE.name: s.STAGE for s in (supply, accumulator, fluid)}
"""Stages that all joints of a rig share."""

JOINT_STAGES: dict[str, Stage] = {
    s.STAGE.name: s.STAGE
    for s in (command, amplifier, solenoid, valve, load_holding, hose, cylinder, linkage, load, base, sensor)
}
"""Stages that each joint has of its own, in the order from command to sensor."""

STAGES: dict[str, Stage] = {**SHARED_STAGES, **JOINT_STAGES}

EFFECT_RECORD = np.dtype(
    [(effect.key, [(p.name, np.float64) for p in effect.parameters]) for effect in EFFECTS.values()]
)
JOINT = np.dtype(
    [(stage.name, stage.dtype()) for stage in STAGES.values()]
    + [("effects", EFFECT_RECORD), ("law", LAW_RECORD), ("driven", DRIVEN)]
)

_NAMES = JOINT.names or ()
_USUAL = np.dtype(
    {
        "names": [*_NAMES, MARK],
        "formats": [*(JOINT[name] for name in _NAMES), np.dtype(np.float64)],
        "offsets": [*(JOINT.fields[name][1] for name in _NAMES), 0],  # type: ignore[index]
        "itemsize": JOINT.itemsize,
    }
)  # type: ignore[call-overload]


def as_usual(joints: np.ndarray) -> np.ndarray:
    """The records, as the type for which rollouts are compiled without rare variants if none of them has any."""
    for stage, variants in RARE.items():
        if np.isin(joints[stage]["variant"], [STAGES[stage].code(variant) for variant in variants]).any():
            return joints
    if is_driven(joints) or any((joints[stage][name] > 0.0).any() for stage, name in RARE_NUMBERS):
        return joints
    return joints.view(_USUAL)


def flat(joints: np.ndarray) -> np.ndarray:
    """The records (n,) as vectors (n, numbers per joint) that share their memory."""
    return joints.view(np.float64).reshape(len(joints), JOINT.itemsize // 8)


def copied(joints: np.ndarray) -> np.ndarray:
    """The records again, with memory of their own; as vectors, since NumPy copies records number by number."""
    return flat(joints).copy().view(JOINT).reshape(len(joints))


def position_of(section: str, name: str) -> int:
    """Where a parameter stands in a flat record; `section` is a stage, "driven", or an effect's key."""
    if section in STAGES or section == "driven":
        outer = JOINT.fields[section][1]  # type: ignore[index]
        inner = JOINT[section].fields[name][1]  # type: ignore[index]
        return int(outer + inner) // 8
    outer = JOINT.fields["effects"][1]  # type: ignore[index]
    middle = EFFECT_RECORD.fields[section][1]  # type: ignore[index]
    inner = EFFECT_RECORD[section].fields[name][1]  # type: ignore[index]
    return int(outer + middle + inner) // 8
