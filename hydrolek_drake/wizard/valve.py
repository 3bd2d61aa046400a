"""The valve's section of a rig that follows from a data sheet."""

import math
from collections.abc import Mapping
from typing import Any

from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.entries import SHEET, asked, entry, kept
from hydrolek_drake.wizard.questions import fixed
from hydrolek_drake.wizard.sheet import EDGES, Sheet


def valve(sheet: Sheet) -> list[str]:
    """The valve's section: four edges, or a compensated flow."""
    return _compensated(sheet) if sheet["compensated"] == "yes" else _edges(sheet)


def _edges(sheet: Sheet) -> list[str]:
    flow = "rated_flow" in sheet.answers
    source = (
        f"{SHEET}: {'flow at the rated drop' if flow else 'spool diameter and share of its circumference'}"
    )
    return [
        "valve:",
        "  variant: four_edges",
        f"  {asked(sheet, 'spool_travel', 'full_opening')}",
        f"  {asked(sheet, 'overlap', 'overlap_pa')}",
        *(f"  overlap_{edge}: {{same_as: overlap_pa}}" for edge in EDGES[1:]),
        *(
            f"  {entry(f'area_gradient_{edge}', 1e3 * gradient, 'mm', source)}"
            for edge, gradient in sheet.gradients.items()
        ),
        f"  {_discharge(sheet)}",
        f"  {kept('edge_rounding')}",
    ]


def _discharge(sheet: Sheet) -> str:
    """Flow coefficient, which stands for what is not known of a rated flow too."""
    if "rated_flow" not in sheet.answers:
        return asked(sheet, "flow_coefficient", "discharge")
    value, spread = sheet["flow_coefficient"], fixed("rated_flow_factor")
    source = f"{SHEET}: with the edges' areas it gives the rated flow; {spread['source']}"
    return entry("discharge", value, "1", source, (value / spread["value"], value * spread["value"]))


def _compensated(sheet: Sheet) -> list[str]:
    """A valve whose flow follows its command whatever the load, as long as enough pressure is left for it."""
    inwards, _, outwards, _ = sheet.rated_flows
    drop, drops = sheet["rated_drop"], fixed("compensator_factor")
    flows = fixed("rated_flow_factor")
    back = outwards / math.sqrt(drop)

    def about(name: str, value: float, unit: str, source: str, spread: Mapping[str, Any]) -> str:
        limits = (value / spread["value"], value * spread["value"])
        return entry(name, value, unit, f"{SHEET}: {source}; {spread['source']}", limits)

    return [
        "valve:",
        "  variant: pressure_compensated",
        f"  {asked(sheet, 'overlap', 'overlap_a')}",
        "  overlap_b: {same_as: overlap_a}",
        f"  {asked(sheet, 'spool_travel', 'full_opening_a')}",
        "  full_opening_b: {same_as: full_opening_a}",
        f"  {about('full_flow', inwards / si_factor('l/min', 'm^3/s'), 'l/min', 'rated flow', flows)}",
        f"  {about('compensator_pressure', drop / si_factor('bar', 'Pa'), 'bar', 'rated drop', drops)}",
        f"  {about('return_coefficient', back, 'm^3/(s Pa^0.5)', 'rated flow at the rated drop', flows)}",
    ]
