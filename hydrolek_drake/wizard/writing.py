"""The commented rig file that follows from a data sheet."""

import math

from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.components import accumulator, holding, hose, slew_rate
from hydrolek_drake.wizard.contacts import end_stops, link_stops, play
from hydrolek_drake.wizard.entries import SHEET, asked, beginning, entry, kept
from hydrolek_drake.wizard.questions import fixed, questions
from hydrolek_drake.wizard.sheet import Sheet
from hydrolek_drake.wizard.valve import valve


def rig_text(name: str, sheet: Sheet, step: float) -> str:
    """The file.

    Args:
        name: of the machine.
        sheet: what its data sheet says.
        step: longest step of the integration [s].
    """
    pump = _pump(sheet) if sheet.pump else [kept("flow_time_constant")]
    lines = [
        *beginning(name, sheet, step, "the spool's step is stable at any stiffness"),
        "  # columns: {their name: joint.angle_deg}  # names of your file's columns, if they differ",
        "",
        "supply:",
        f"  variant: {'pump' if sheet.pump else 'constant_pressure'}",
        f"  {asked(sheet, 'supply_pressure', 'pressure')}",
        f"  {asked(sheet, 'tank_pressure')}",
        *(f"  {line}" for line in pump),
        "",
        *accumulator(sheet),
        "fluid:",
        "  variant: polytropic_air  # counts where there is air",
        f"  {asked(sheet, 'oil_density', 'density')}",
        f"  {asked(sheet, 'bulk_modulus')}",
        f"  {kept('laminar_transition')}",
        f"  {kept('atmospheric_pressure')}",
        f"  {kept('cavity_refilled')}",
        f"  {kept('air_exponent')}",
        "",
        "joints:",
        f"  {sheet['joint']}:",
        "    command:",
        f"      {asked(sheet, 'delay')}",
        f"      {asked(sheet, 'full_command', 'limit')}",
        f"      {asked(sheet, 'neutral_command', 'neutral')}",
        f"      {_polarity(sheet)}",
        "    amplifier: {variant: none}  # the valve has its own",
        "    solenoid:",
        "      variant: servo_valve",
        f"      {asked(sheet, 'full_command', 'rated_voltage')}",
        f"      {asked(sheet, 'spool_travel', 'full_stroke')}",
        f"      {asked(sheet, 'bandwidth')}",
        f"      {asked(sheet, 'spool_damping', 'damping_ratio')}",
        *(f"      {line}" for line in slew_rate(sheet)),
        *(f"    {line}" for line in valve(sheet)),
        *(f"    {line}" for line in (*holding(sheet), *hose(sheet))),
        *(f"    {line}" for line in _cylinder(sheet)),
        *(f"    {line}" for line in (_link(sheet) if sheet.turns else _slide(sheet))),
        *(f"    {line}" for line in _effects(sheet)),
        "",
    ]
    return "\n".join(lines)


def _polarity(sheet: Sheet) -> str:
    """Which commands extend the rod."""
    source = SHEET if "extends_at" in sheet.answers else "assumed: -1 if a command above neutral retracts"
    return entry("polarity", 1.0 if sheet["extends_at"] == "above" else -1.0, "1", source)


def _pump(sheet: Sheet) -> list[str]:
    return [
        asked(sheet, "displacement"),
        asked(sheet, "pump_speed", "speed"),
        _leak(sheet),
        _rise(sheet),
        asked(sheet, "relief_hysteresis"),
        asked(sheet, "relief_time"),
        asked(sheet, "line_volume"),
        *_line_at_start(sheet),
    ]


def _line_at_start(sheet: Sheet) -> list[str]:
    """The line where a recording begins, which a fit finds: at rest, or with a pump that was just switched on."""
    bar = si_factor("bar", "Pa")
    rest = sheet["supply_pressure"] + sheet["relief_rise"]
    limits = (sheet["tank_pressure"] / bar, 1.1 * rest / bar)
    return [
        entry("initial_pressure", rest / bar, "bar", "assumed: at rest", limits, log=False),
        entry("initial_relief", 1.0, "1", "assumed: at rest; 0 with the valve closed", (0.0, 1.0)),
    ]


def _leak(sheet: Sheet) -> str:
    """What the pump loses for each pressure, from what it loses at the relief valve's setting."""
    question = questions()["pump_leakage"]
    at_setting = 1.0 / sheet["supply_pressure"]
    most = question.what["assumed_upper_share"] * sheet.whole("pump_leakage")
    source = SHEET if "pump_leakage" in sheet.answers else question.what["known"]
    lost = sheet["pump_leakage"]
    limits = (0.0, max(most, 2.0 * lost) * at_setting)
    return entry("pump_leakage", lost * at_setting, "m^3/(s Pa)", source, limits, log=False)


def _rise(sheet: Sheet) -> str:
    """Slope of the relief valve, from its rise when it lets all off."""
    what = questions()["relief_rise"].what
    given = "relief_rise" in sheet.answers
    slope = sheet["relief_rise"] / (sheet["displacement"] * sheet["pump_speed"])
    spread = what["factor"] if given else what["assumed_factor"]
    return entry(
        "relief_slope", slope, "Pa s/m^3", SHEET if given else what["known"], (slope / spread, slope * spread)
    )


def _mass_place(name: str, value: float) -> str:
    """A distance of the mass where nobody has said how it is spread."""
    spread = fixed("mass_place_factor")
    limits = (value / spread["value"], value * spread["value"])
    return entry(name, value, "m", f"assumed: spread evenly over the length; {spread['source']}", limits)


def _cylinder(sheet: Sheet) -> list[str]:
    return [
        "cylinder:",
        "  variant: cylinder",
        f"  {entry('area_a', 1e6 * sheet.area_a, 'mm^2', f'{SHEET}: bore')}",
        f"  {entry('area_b', 1e6 * sheet.area_b, 'mm^2', f'{SHEET}: bore and rod')}",
        f"  {asked(sheet, 'dead_volume', 'dead_volume_a')}",
        f"  {asked(sheet, 'dead_volume', 'dead_volume_b')}",
        f"  {_end(sheet, 'stroke', sheet['stroke'], SHEET)}",
        *(f"  {line}" for line in end_stops(sheet)),
        f"  {_column(sheet)}",
        f"  {_at_start(sheet)}",
        f"  {asked(sheet, 'seal_damping', 'viscous_friction')}",
        *(f"  {kept(name)}" for name in ("friction_velocity", "bristle_deflection", "bristle_time")),
    ]


def _at_start(sheet: Sheet) -> str:
    """Pressure of side B at the start, which a fit finds."""
    supply, tank = sheet["supply_pressure"], sheet["tank_pressure"]
    bar = si_factor("bar", "Pa")
    lowest = 0.5 * min(tank or supply, 0.02 * supply)  # a falling load may draw it below the tank's
    limits = (lowest / bar, supply / bar)
    return entry("initial_pressure_b", 0.5 * supply / bar, "bar", "assumed: half of the supply", limits)


def _column(sheet: Sheet) -> str:
    """Compliance that an oil column has at least, as a share of that of side A in mid-stroke."""
    share, spread = fixed("column_share"), fixed("stop_depth_factor")["value"]
    volume = sheet["dead_volume"] + 0.5 * sheet["stroke"] * sheet.area_a
    least = share["value"] * volume / (sheet["bulk_modulus"] * sheet.area_a**2)
    return entry("column_compliance", least, "m/N", share["source"], (least / spread, least * spread))


def _end(sheet: Sheet, name: str, value: float, source: str) -> str:
    """Where the stroke ends or begins [mm], to within what rods are screwed and built to."""
    spread = 1e3 * fixed("stop_place")["value"] / 100.0 * sheet["stroke"]
    limits = (max(1e3 * value - spread, 0.0), 1e3 * value + spread)
    return entry(name, 1e3 * value, "mm", source, limits, log=False)


def _beyond(lower: float, upper: float, unit: str, of: str) -> list[str]:
    """The load's own stops: none where the cylinder has some."""
    rim = 0.05 * (upper - lower)
    none = "none: the cylinder's own stops act"
    torque = "N m" if of == "rad" else "N"
    return [
        entry("lower_stop", lower - rim, unit, "assumed: behind the cylinder's own stop"),
        entry("upper_stop", upper + rim, unit, "assumed: behind the cylinder's own stop"),
        entry("stop_stiffness", 0.0, f"{torque}/{of}", none),
        entry("stop_damping", 0.0, f"{torque} s/{of}", none),
    ]


def _link(sheet: Sheet) -> list[str]:
    lower, upper = math.degrees(sheet.lower), math.degrees(sheet.upper)
    rim = 0.1 * (upper - lower)
    along, across = sheet.answers.get("centre", (0.5 * sheet["length"], 0.0))
    weighs = entry("gravity", 0.0, "m/s^2", SHEET) if sheet["upright"] == "yes" else kept("gravity")
    even, place = "assumed: spread evenly over the length", f"{SHEET}: place"
    told = "centre" in sheet.answers
    stops = link_stops(sheet) if sheet.own_stops else _beyond(lower, upper, "deg", "rad")
    return [
        "linkage:",
        "  variant: triangle",
        f"  {entry('distance_parent', sheet.parent, 'm', f'{SHEET}: base mount')}",
        f"  {entry('distance_child', sheet.child, 'm', f'{SHEET}: link mount')}",
        f"  {entry('angle_offset', math.degrees(sheet.offset), 'deg', f'{SHEET}: mounts at joint angle zero')}",
        f"  {entry('direction', sheet.direction, '1', f'{SHEET}: extension turns the link this way')}",
        f"  {_end(sheet, 'zero_stroke_length', sheet.zero_length, f'{SHEET}: mounts and stroke')}",
        *(f"  {line}" for line in play(sheet)),
        "load:",
        "  variant: link",
        f"  {asked(sheet, 'mass')}  # inertia and gravity follow from it and its place",
        f"  {entry('centre_along', along, 'm', place) if told else _mass_place('centre_along', along)}",
        f"  {entry('centre_across', across, 'm', place if told else even)}",
        f"  {_mass_place('gyration_radius', sheet['length'] / math.sqrt(12.0))}",
        f"  {weighs}",
        *(f"  {line}" for line in _carried(sheet)),
        f"  {asked(sheet, 'bearing_damping', 'damping')}",
        f"  {kept('friction_velocity', 'bearing_friction_velocity')}",
        *(f"  {line}" for line in stops),
        f"  {entry('initial_position', math.degrees(sheet['mid_stroke_at']), 'deg', 'half of the stroke')}",
        "sensor:",
        "  variant: position",
        f"  {entry('travel_lower', lower - rim, 'deg', 'assumed: a tenth more than the stops')}",
        f"  {entry('travel_upper', upper + rim, 'deg', 'assumed: a tenth more than the stops')}",
        f"  {asked(sheet, 'angle_noise', 'noise')}",
        '  resolution: {value: 0, unit: deg, source: "told by the recording"}',
        f"  {asked(sheet, 'pressure_noise')}",
    ]


def _carried(sheet: Sheet) -> list[str]:
    """What a kilogram does that is picked up, at the end of the link beyond its centre of mass.

    How far that is, its weight tells beside it.
    """
    where = "assumed: what is picked up hangs at the end of the link"
    length = sheet["length"]
    weight = 0.0 if sheet["upright"] == "yes" else fixed("gravity")["value"] * length
    x, y = sheet.answers.get("centre", (1.0, 0.0))
    away = math.hypot(x, y) or 1.0
    spread = fixed("payload_place_factor")
    inertia, unit = length**2, "kg m^2/kg"
    limits = (inertia / spread["value"], inertia * spread["value"]) if weight else None
    return [
        entry("payload_inertia", inertia, unit, f"{where}; {spread['source']}" if limits else where, limits),
        entry("payload_gravity_cos", weight * x / away, "N m/kg", where),
        *([entry("payload_gravity_sin", -weight * y / away, "N m/kg", where)] if y else []),
    ]


def _effects(sheet: Sheet) -> list[str]:
    """What is known of effects that are off: how a further friction at rest would fade."""
    fading = f"stribeck_friction: {{{kept('fading_exponent')}}}"
    return ["effects:", f"  cylinder.{fading}", *([f"  load.{fading}"] if sheet.turns else [])]


def _slide(sheet: Sheet) -> list[str]:
    stroke = 1e3 * sheet["stroke"]
    return [
        "linkage:",
        "  variant: direct",
        '  zero_stroke_position: {value: 0, unit: m, source: "the position counts from the retracted end"}',
        '  direction: {value: 1, unit: "1", source: "extension counts as positive"}',
        *(f"  {line}" for line in play(sheet)),
        "load:",
        "  variant: sliding",
        f"  {asked(sheet, 'mass', 'inertia')}",
        f"  {asked(sheet, 'guide_damping', 'damping')}",
        *(f"  {line}" for line in _beyond(0.0, stroke, "mm", "m")),
        f"  {entry('initial_position', 0.5 * stroke, 'mm', 'half of the stroke')}",
        "sensor:",
        "  variant: position",
        f"  {entry('travel_lower', -0.1 * stroke, 'mm', 'assumed: a tenth more than the stroke')}",
        f"  {entry('travel_upper', 1.1 * stroke, 'mm', 'assumed: a tenth more than the stroke')}",
        f"  {asked(sheet, 'position_noise', 'noise')}",
        '  resolution: {value: 0, unit: mm, source: "told by the recording"}',
        f"  {asked(sheet, 'pressure_noise')}",
    ]
