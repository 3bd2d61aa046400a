"""Sections of a rig for what meets what: the piston its stops, the rod's side of a worn pin the link's."""

import math

from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.entries import entry, kept
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


def play(sheet: Sheet) -> list[str]:
    """What meets where a pin is worn: the rod's side, and how hard its contact is. Counts with a play alone."""
    lever, of = (sheet.lever, "rad") if sheet.turns else (1.0, "m")
    force, inertia_unit = ("N m", "kg m^2") if sheet.turns else ("N", "kg")
    rod, less, more = fixed("moving_with_rod"), fixed("moving_with_rod_less"), fixed("moving_with_rod_more")
    contact, softer, harder = fixed("play_contact"), fixed("play_softer"), fixed("play_harder")
    rod_area = sheet.area_a - sheet.area_b
    inertia = rod["value"] * fixed("steel")["value"] * rod_area * sheet["stroke"] * lever**2
    stiffness = inertia * (2.0 * math.pi * contact["value"]) ** 2
    damping = math.sqrt(stiffness * inertia)
    lightest, heaviest = inertia / less["value"], inertia * more["value"]
    softest, hardest = stiffness / softer["value"], stiffness * harder["value"]
    spread = more["value"]
    return [
        entry(
            "play_inertia", inertia, inertia_unit, f"{rod['source']}; {more['source']}", (lightest, heaviest)
        ),
        entry("play_stiffness", stiffness, f"{force}/{of}", contact["source"], (softest, hardest)),
        entry(
            "play_damping",
            damping,
            f"{force} s/{of}",
            f"assumed: half of critical with the rod; {more['source']}",
            (damping / spread, damping * spread),
        ),
    ]
