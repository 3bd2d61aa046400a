"""Machines of the usual variants, for which a rollout is compiled without the others.

Each variant of a stage is a branch in the innermost loop, and even one that is never taken costs time. Records of
machines without any of `RARE` are handed to compiled code as another type, of the same memory (`records.as_usual`),
for which `rare` is a constant: whatever stands behind it is left out. In lanes all variants are constants.
"""

from typing import Any

from numba import types
from numba.extending import intrinsic

MARK = "usual"
"""Field that tells the two types of records apart; it lies upon the first number."""

RARE: dict[str, tuple[str, ...]] = {
    "supply": ("pump",),
    "accumulator": ("gas",),
    "fluid": ("polytropic_air",),
    "amplifier": ("pwm",),
    "solenoid": ("switching",),
    "valve": ("four_edges", "flow_map", "pump_controlled"),
    "holding": ("counterbalance", "pilot_check"),
    "hose": ("hose", "long_line"),
    "cylinder": ("ball_screw", "servo_screw"),
    "linkage": ("four_bar", "lever_table"),
    "load": ("link",),
}
"""Stage -> its variants that stand behind `rare`."""

RARE_NUMBERS: tuple[tuple[str, str], ...] = (
    ("cylinder", "stop_stiffness"),
    ("cylinder", "column_compliance"),
    ("cylinder", "bristle_deflection"),
    ("solenoid", "slew_rate"),
)
"""Stages and their parameters that stand behind it where they are above zero."""


@intrinsic
def rare(typing_context: Any, joint: Any) -> Any:
    """Whether a joint may have one of the variants of `RARE`: a constant of what is compiled for its type."""
    usual = isinstance(joint, types.Record) and MARK in joint.fields

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.get_constant(types.boolean, not usual)

    return types.boolean(joint), generate
