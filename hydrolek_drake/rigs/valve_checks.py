"""Checks of a rig's valves."""

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.valves import flow_map
from hydrolek_drake.physics.valves.variants import EDGES
from hydrolek_drake.rigs.checked import Checked


def check(rig: Checked, where: str) -> None:
    """Refuse a valve that never opens.

    Raises:
        InputError: an overlap as long as the travel, or a flow map whose pressure drops do not rise.
    """
    variant = rig.variants[f"{where}.valve"]
    if variant in ("none", "pump_controlled"):
        return
    overlaps, full = {"four_edges": (EDGES, "full_opening"), "flow_map": (("a", "b"), "full_travel")}.get(
        variant, (("a", "b"), "")
    )
    for side in overlaps:
        name = full or f"full_opening_{side}"
        overlap, travel = (rig.value(f"{where}.valve.{key}") for key in (f"overlap_{side}", name))
        if not overlap < travel:
            raise InputError(
                f"{rig.path}: {where}.valve: {name} ({travel:g} m) must be larger than "
                f"overlap_{side} ({overlap:g} m)"
            )
    if variant == "flow_map":
        drops = [rig.value(f"{where}.valve.drop_{drop}") for drop in flow_map.DROPS]
        if not drops[0] < drops[1] < drops[2]:
            raise InputError(
                f"{rig.path}: {where}.valve: drop_low, drop_middle, drop_high must rise, not "
                f"{', '.join(f'{drop:g}' for drop in drops)} Pa"
            )
