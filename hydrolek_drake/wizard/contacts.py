"""Sections of a rig for what meets what: the piston its stops, the rod's side of a worn pin the link's."""

import math

from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.entries import SHEET, entry, kept
from hydrolek_drake.wizard.questions import fixed
from hydrolek_drake.wizard.sheet import Sheet


def end_stops(sheet: Sheet) -> list[str]:
    """The piston's stops where the stroke ends; the largest force presses them in by a little."""
    depth, spread = fixed("stop_depth"), fixed("stop_depth_factor")["value"]
    stiffness = sheet.force / (depth["value"] * si_factor(depth["unit"], "m"))
    lever = sheet.lever if sheet.turns else 1.0
    moving = sheet["mass"] * (sheet["length"] / lever) ** 2 / 3.0 if sheet.turns else sheet["mass"]
    damping = math.sqrt(stiffness * moving)
    return [
        entry("stop_stiffness", stiffness, "N/m", depth["source"], (stiffness / spread, stiffness * spread)),
        entry(
            "stop_damping",
            damping,
            "N s/m",
            f"assumed: half of critical with the mass; {fixed('stop_depth_factor')['source']}",
            (damping / spread**2, damping * spread),
        ),
        *(kept(name) for name in ("stop_exponent", "stop_dissipation")),
    ]


def link_stops(sheet: Sheet) -> list[str]:
    """Stops of the link's own, into which the largest moment presses it as far as the largest force does the piston."""
    depth, spread = fixed("stop_depth"), fixed("stop_depth_factor")
    stiffness = sheet.force * sheet.lever**2 / (depth["value"] * si_factor(depth["unit"], "m"))
    damping = math.sqrt(stiffness * sheet["mass"] * sheet["length"] ** 2 / 3.0)
    factor, told = spread["value"], spread["source"]
    told_hard = f"{depth['source']}; {told}"
    told_damped = f"assumed: half of critical with the mass; {told}"
    return [
        entry("lower_stop", math.degrees(sheet.lower), "deg", SHEET),
        entry("upper_stop", math.degrees(sheet.upper), "deg", SHEET),
        entry("stop_stiffness", stiffness, "N m/rad", told_hard, (stiffness / factor, stiffness * factor)),
        entry("stop_damping", damping, "N m s/rad", told_damped, (damping / factor**2, damping * factor)),
    ]


def play(sheet: Sheet) -> list[str]:
    """What meets where a pin is worn: the rod's side, and how hard its contact is. Counts with a play alone."""
    force, of, inertia_unit = ("N m", "rad", "kg m^2") if sheet.turns else ("N", "m", "kg")
    moving = sheet["mass"] * sheet["length"] ** 2 / 3.0 if sheet.turns else sheet["mass"]
    behind, contact = fixed("behind_play"), fixed("play_contact")
    spread, harder = fixed("behind_play_factor"), fixed("play_contact_factor")
    inertia = behind["value"] * moving
    stiffness = inertia * (2.0 * math.pi * contact["value"]) ** 2
    damping = math.sqrt(stiffness * inertia)
    closed = f"assumed: half of critical with the rod's side; {harder['source']}"

    def around(value: float, factor: float) -> tuple[float, float]:
        return value / factor, value * factor

    return [
        entry("play_inertia", inertia, inertia_unit, behind["source"], around(inertia, spread["value"])),
        entry(
            "play_stiffness",
            stiffness,
            f"{force}/{of}",
            contact["source"],
            around(stiffness, harder["value"]),
        ),
        entry("play_damping", damping, f"{force} s/{of}", closed, around(damping, harder["value"])),
    ]
