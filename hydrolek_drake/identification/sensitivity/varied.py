"""Which parameters of a joint's chain a sensitivity study varies, and over what range."""

from dataclasses import dataclass

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.physics.records import SHARED_STAGES
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.rig import declaration

BOOKKEEPING = frozenset(
    {
        "command.polarity",
        "command.module",
        "command.channel_a",
        "command.channel_b",
        "linkage.direction",
        "linkage.assembly",
        "holding.at_a",
        "holding.at_b",
        "sensor.noise",
        "sensor.pressure_noise",
        "sensor.current_noise",
        "sensor.current_size",
    }
)
"""Parameters that say how things are wired or how noisy a reading is: no number that could be a little off."""


@dataclass(frozen=True)
class Varied:
    """What is varied and what is not.

    Attributes:
        free: parameters with the range over which each is varied.
        left_out: path -> why it is not.
    """

    free: tuple[Free, ...]
    left_out: dict[str, str]


def varied_parameters(rig: Rig, joint: str, spread: float, paths: list[str] | None = None) -> Varied:
    """Every parameter of the joint's chain: over its range in the rig, else `spread` to both sides.

    Args:
        rig: the machine.
        joint: whose chain, supply and fluid included; effects that are off stay off.
        spread: part of the value by which a parameter without a range is varied, such as 0.2.
        paths: only these; None for all.

    Raises:
        InputError: no such joint or parameter, a spread that is not between 0 and 1, or nothing to vary.
    """
    if joint not in rig.joints:
        raise InputError(f"rig {rig.name} has no joint '{joint}'; choose {', '.join(rig.joints)}")
    if not 0.0 < spread < 1.0:
        raise InputError(f"--spread {spread:g}: choose a part of the value between 0 and 1, such as 0.2")
    chosen = list(rig.entries) if paths is None else [rig.full_path(path) for path in paths]
    free, left_out = [], {}
    for path in chosen:
        stage, _, name = path.removeprefix(f"joints.{joint}.").rpartition(".")
        own = path.startswith(f"joints.{joint}.") or stage in SHARED_STAGES
        if not own or (paths is None and ".effects." in path):
            continue
        entry = rig.entries[path]
        value = rig.value(path)
        if f"{stage}.{name}" in BOOKKEEPING:
            left_out[path] = "wiring or noise"
        elif entry.same_as is not None:
            left_out[path] = f"follows {entry.same_as}"
        elif entry.range is not None:
            free.append(Free(path, *entry.range, log=entry.scale == "log"))
        elif value == 0.0:
            left_out[path] = "zero, and the rig gives no range"
        else:
            declared = declaration(rig, path)
            low, high = sorted((value * (1.0 - spread), value * (1.0 + spread)))
            free.append(Free(path, max(low, declared.lowest), min(high, declared.highest)))
    kept = []
    for one in free:
        try:
            ParameterSet(rig, [one])
        except InputError as error:
            left_out[one.path] = str(error)
            continue
        kept.append(one)
    if not kept:
        raise InputError(f"rig {rig.name}, {joint}: nothing can be varied: {left_out}")
    return Varied(tuple(kept), left_out)
