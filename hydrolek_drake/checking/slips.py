"""Slips of unit: values that are a known factor too large or too small, and the line of a rig that mends them."""

import math

UNITS = {
    "rad": ((180.0 / math.pi, "deg in a column of rad", "deg"), (math.pi / 180.0, "rad in a column of deg", "rad")),
    "m": ((1e3, "mm in a column of m", "mm"), (1e-3, "m in a column of mm", "m")),
    "Pa": (
        (1e-5, "bar in a column of Pa", "bar"), (1e-6, "MPa in a column of Pa", "MPa"),
        (1e-3, "kPa in a column of Pa", "kPa"),
        (1e5, "Pa in a column of bar", "Pa"), (1e6, "Pa in a column of MPa", "Pa"),
        (10.0, "bar in a column of MPa", "bar"),
        (0.1, "MPa in a column of bar", "MPa"), (1e3, "Pa in a column of kPa", "Pa"),
    ),
    "V": ((1e3, "mV in a column of V", "mV"), (1e-3, "V in a column of mV", "V")),
}  # fmt: skip
"""SI unit -> factor by which values are off, the slip that makes it, and the unit that they have."""

NEAR_FACTOR = 2.0
"""A ratio within this factor of a slip's is that slip, where it is further than `ANOTHER` from one."""

ANOTHER = 5.0


def column(key: str, unit: str, to: str) -> str:
    """The line of the rig that gives a column another unit."""
    return f"recording: {{columns: {{{key}_{unit}: {key}_{to}}}}}"


def slip_of(ratio: float, unit: str) -> tuple[str, str] | None:
    """Which slip of unit makes values so many times too large: what it is called, and the unit that they have."""
    if not ratio > 0.0 or 1.0 / ANOTHER < ratio < ANOTHER:
        return None
    for factor, called, has in UNITS[unit]:
        if 1.0 / NEAR_FACTOR < ratio / factor < NEAR_FACTOR:
            return called, has
    return None
