"""`recording: {driven_by: [...]}` of a rig: recorded signals that drive its model in place of a part of it.

```yaml
recording:
  columns: {P_S: supply.pressure_bar, LVDT: boom.spool_mm}
  driven_by: [supply.pressure, boom.spool]
```
"""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.cylinder import ELECTRIC
from hydrolek_drake.physics.driven import CHAMBERS_ONLY, UPSTREAM

SUPPLY = "supply.pressure"
SPOOL = "spool"
CHAMBERS = ("pressure_a", "pressure_b")


def read_driven_by(raw: Any, joints: Sequence[str], variants: dict[str, str], path: Path) -> tuple[str, ...]:
    """Check the list.

    Raises:
        InputError: no list, a signal that cannot drive, one chamber without the other, or a joint without oil.
    """
    where = f"{path}: recording.driven_by"
    choices = [SUPPLY, *(f"{joint}.{name}" for joint in joints for name in (SPOOL, *CHAMBERS))]
    if raw is None:
        return ()
    if not isinstance(raw, list) or not all(isinstance(key, str) for key in raw):
        raise InputError(f"{where} must be a list of recorded signals, such as [{SUPPLY}]")
    for key in raw:
        if key not in choices:
            raise InputError(f"{where}: '{key}' drives nothing; choose {', '.join(choices)}")
        joint = key.partition(".")[0]
        if key != SUPPLY and variants[f"joints.{joint}.cylinder"] in ELECTRIC:
            raise InputError(f"{where}: {key}: {joint} has an electric motor, which has no oil")
        if key == f"{joint}.{SPOOL}" and variants[f"joints.{joint}.solenoid"] == "none":
            raise InputError(f"{where}: {key}: {joint} has no spool")
    for joint in joints:
        there = [name for name in CHAMBERS if f"{joint}.{name}" in raw]
        if len(there) == 1:
            raise InputError(
                f"{where}: {joint}.{there[0]} alone drives nothing; both of {joint}.{CHAMBERS[0]} and "
                f"{joint}.{CHAMBERS[1]} do"
            )
    return tuple(dict.fromkeys(raw))


def signals_of(driven_by: Sequence[str], joint: str) -> dict[str, tuple[str, ...]]:
    """Fields of `physics.driven.DRIVEN` that are on for a joint, and the recorded signals of each."""
    parts = {
        "supply_pressure": (SUPPLY,),
        "spool_position": (f"{joint}.{SPOOL}",),
        "chamber_pressures": tuple(f"{joint}.{name}" for name in CHAMBERS),
    }
    return {part: keys for part, keys in parts.items() if keys[0] in driven_by}


def counts(path: str, driven_by: Sequence[str], joints: Sequence[str]) -> bool:
    """Whether a parameter still counts: what it stands for is not replaced by a recording.

    Args:
        path: full path of the parameter.
        driven_by: signals that drive the rig.
        joints: of the rig.
    """
    if not driven_by:
        return True
    of = path.split(".")[1:2] if path.startswith("joints.") else joints
    return not all(_is_replaced(path, signals_of(driven_by, joint)) for joint in of)


def _is_replaced(path: str, parts: Collection[str]) -> bool:
    section, _, name = path.rpartition(".")
    added = next((kind for kind in (".effects.", ".law.") if kind in section), None)
    stage = section.split(added)[-1].split(".")[0] if added else section.split(".")[-1]
    if name == "tank_pressure" and "chamber_pressures" not in parts:
        return False
    if stage == "cylinder" and name in CHAMBERS_ONLY:
        return "chamber_pressures" in parts
    return any(stage in UPSTREAM[part] for part in parts)
