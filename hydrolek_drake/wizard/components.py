"""Sections of a rig for what a machine may have besides: accumulator, hoses, load holding, a limited spool speed."""

import math

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.entries import SHEET, asked, entry, kept
from hydrolek_drake.wizard.questions import fixed, questions
from hydrolek_drake.wizard.sheet import Sheet


def _si(name: str, unit: str) -> float:
    """A number that no data sheet has, in SI."""
    known = fixed(name)
    return float(known["value"] * si_factor(known["unit"], unit))


def accumulator(sheet: Sheet) -> list[str]:
    """Gas on the pump's line."""
    if "accumulator_volume" not in sheet.answers:
        return []
    return [
        "accumulator:",
        "  variant: gas",
        f"  {asked(sheet, 'accumulator_volume', 'volume')}",
        f"  {asked(sheet, 'accumulator_precharge', 'precharge')}",
        f"  {kept('exponent', 'gas_exponent')}",
        "",
    ]


def slew_rate(sheet: Sheet) -> list[str]:
    """Highest speed of the spool, from its time for the full travel."""
    if "slew_time" not in sheet.answers:
        return []
    rate = 1e3 * sheet["spool_travel"] / sheet["slew_time"]
    spread = questions()["slew_time"].what["factor"]
    source = f"{SHEET}: full travel over its time"
    return [entry("slew_rate", rate, "mm/s", source, (rate / spread, rate * spread))]


def holding(sheet: Sheet) -> list[str]:
    """A counterbalance or pilot-operated check valve at one port or both."""
    variant, at = sheet["holding"], sheet["holding_at"]
    if variant == "none":
        return []
    area = fixed("holding_area")
    widest = sheet.gradients["pa"] * (sheet["spool_travel"] - sheet["overlap"])
    first = (
        asked(sheet, "holding_setting", "setting")
        if variant == "counterbalance"
        else kept("cracking", "holding_crack")
    )
    return [
        "holding:",
        f"  variant: {variant}",
        f"  {first}",
        f"  {asked(sheet, 'holding_ratio', 'pilot_ratio')}",
        f"  {kept('full_rise', 'holding_rise')}",
        f"  {entry('area', 1e6 * area['value'] * widest, 'mm^2', area['source'])}",
        f"  {entry('discharge', sheet['flow_coefficient'], '1', 'assumed: as the edges have it')}",
        *(f"  {entry(f'at_{port}', float(at in (port, 'both')), '1', SHEET)}" for port in ("a", "b")),
    ]


def hose(sheet: Sheet) -> list[str]:
    """Hoses that widen, with the laminar loss of a round tube, 128 nu rho l/(pi d^4)."""
    given = [key for key in ("hose_length", "hose_bore") if key in sheet.answers]
    if not given:
        return []
    if len(given) == 1:
        other = "--hose-bore" if given[0] == "hose_length" else "--hose-length"
        raise InputError(
            f"rig new: --{given[0].replace('_', '-')} alone says nothing of a hose; give {other} too"
        )
    length, bore, spread = sheet["hose_length"], sheet["hose_bore"], fixed("hose_factor")
    volume = 0.25 * math.pi * bore * bore * length
    expansion = volume / _si("hose_modulus", "Pa")
    resistance = 128.0 * _si("viscosity", "m^2/s") * sheet["oil_density"] * length / (math.pi * bore**4)

    def both(name: str, value: float, unit: str, source: str) -> list[str]:
        limits = (value / spread["value"], value * spread["value"])
        line = entry(f"{name}_a", value, unit, f"{source}; {spread['source']}", limits)
        return [f"  {line}", f"  {name}_b: {{same_as: {name}_a}}"]

    return [
        "hose:",
        "  variant: hose",
        *both("expansion", expansion, "m^3/Pa", fixed("hose_modulus")["source"]),
        *both(
            "resistance", resistance, "Pa s/m^3", f"laminar, length and bore; {fixed('viscosity')['source']}"
        ),
    ]
