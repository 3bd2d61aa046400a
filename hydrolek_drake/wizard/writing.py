"""The commented rig file that follows from the answers."""

import math
from collections.abc import Mapping
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.sheet import SI, Question, Share, fixed, missing, questions

SHEET = "data sheet"
EDGES = ("pa", "pb", "at", "bt")
"""In the order in which a data sheet's four numbers stand."""


class Sheet:
    """Answers, and what follows from them; SI units.

    Attributes:
        answers: key -> answer, as of `read_answers`.
    """

    def __init__(self, answers: Mapping[str, Any]) -> None:
        """Take answers.

        Raises:
            InputError: what no rig can be written without is missing, or contradicts itself.
        """
        self.answers = answers
        left = missing(answers)
        if left:
            told = "; ".join(f"{q.option} ({q.asks}{f' [{q.unit}]' if q.unit else ''})" for q in left)
            raise InputError(f"rig new: not answered: {told}")
        bore, rod = self["bore"], self["rod"]
        if not 0.0 <= rod < bore:
            raise InputError(f"rig new: --rod {1e3 * rod:g} mm is not thinner than --bore {1e3 * bore:g} mm")
        self.area_a = 0.25 * math.pi * bore * bore
        self.area_b = self.area_a - 0.25 * math.pi * rod * rod
        self.turns = self["moves"] == "link"
        self.pump = self["supply"] == "pump"
        self.force = self.area_a * self["supply_pressure"]
        self.lever = self._geometry() if self.turns else 1.0
        self.gradients = self._gradients()
        self.speed = self._speed()

    def __getitem__(self, key: str) -> Any:
        """An answer, or what is assumed in its place."""
        if key in self.answers:
            given = self.answers[key]
            return given * self[self._question(key).what["percent_of"]] if isinstance(given, Share) else given
        what = self._question(key).what
        if "text" in what:
            return what["text"]
        if "assume" in what:
            return what["assume"] * si_factor_of(self._question(key))
        return what["assume_share"] * self._whole(key)

    def _question(self, key: str) -> Question:
        return questions()[key]

    def _whole(self, key: str) -> float:
        """Of what an assumption is a share."""
        if key == "dead_volume":
            return float(self.area_a * self["stroke"])
        if key == "overlap":
            return float(self["spool_travel"])
        if key == "pump_leakage":
            return self["displacement"] * self["pump_speed"]
        if key in ("relief_rise", "relief_hysteresis"):
            return float(self["supply_pressure"])
        if key == "bearing_damping":
            return self.force * self.lever * self.lever / self.speed
        return self.force / self.speed

    def _geometry(self) -> float:
        """Distances and angles of the triangle; the lever at half of the stroke [m]."""
        (px, py), (cx, cy) = self["base_mount"], self["link_mount"]
        self.parent, self.child = math.hypot(px, py), math.hypot(cx, cy)
        if min(self.parent, self.child) <= 0.0:
            raise InputError("rig new: --base-mount and --link-mount must lie away from the joint axis")
        between = math.atan2(cy, cx) - math.atan2(py, px)
        between = math.remainder(between, 2.0 * math.pi)
        self.direction = 1.0 if between >= 0.0 else -1.0
        self.offset = abs(between)
        included = self.direction * self["mid_stroke_at"] + self.offset
        a, b, half = self.parent, self.child, 0.5 * self["stroke"]
        length = math.sqrt(a * a + b * b - 2.0 * a * b * math.cos(included))
        self.zero_length = length - half
        ends = []
        for end in (length - half, length + half):
            cosine = (a * a + b * b - end * end) / (2.0 * a * b)
            if not 0.0 < included < math.pi or end <= 0.0 or abs(cosine) >= 1.0:
                raise InputError(
                    f"rig new: with mounts {a:g} m and {b:g} m from the axis and {length:g} m between them at half of "
                    f"the stroke, a cylinder cannot reach {end:g} m; check --base-mount, --link-mount, --stroke, "
                    "--mid-stroke-at"
                )
            ends.append(self.direction * (math.acos(cosine) - self.offset))
        self.lower, self.upper = min(ends), max(ends)
        return a * b * math.sin(included) / length

    def _gradients(self) -> dict[str, float]:
        """Area gradient of each edge [m]."""
        if "rated_flow" in self.answers:
            flows = self["rated_flow"]
            flows = flows * 4 if len(flows) == 1 else flows
            speed = self["flow_coefficient"] * math.sqrt(2.0 * self["rated_drop"] / self["oil_density"])
            travel = self["spool_travel"] - self["overlap"]
            return {edge: flow / (speed * travel) for edge, flow in zip(EDGES, flows, strict=True)}
        around = math.pi * self["spool_diameter"]
        return {edge: around * share for edge, share in zip(EDGES, self["port_shares"], strict=True)}

    def _speed(self) -> float:
        """Of the rod with the valve wide open and half of the pressure over its inlet, or all that the pump gives."""
        area = self.gradients["pa"] * (self["spool_travel"] - self["overlap"])
        flow = self["flow_coefficient"] * area * math.sqrt(self["supply_pressure"] / self["oil_density"])
        if self.pump:
            flow = min(flow, self["displacement"] * self["pump_speed"])
        if not flow > 0.0:
            raise InputError("rig new: no oil flows: check openings, overlap, supply pressure and pump")
        return float(flow / self.area_a)


def si_factor_of(question: Question) -> float:
    """Factor from a question's unit to SI."""
    return 2.0 * math.pi if question.unit == "Hz" else si_factor(question.unit, SI[question.unit])


def _number(value: float) -> str:
    """As YAML reads it as a number."""
    text = f"{value:.5g}"
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


def _entry(
    name: str,
    value: float,
    unit: str,
    source: str,
    limits: tuple[float, float] | None = None,
    log: bool = True,
) -> str:
    log = log and limits is not None and limits[0] > 0.0
    fitted = f", range: [{_number(limits[0])}, {_number(limits[1])}]" if limits else ""
    spelled = '"1"' if unit == "1" else unit
    scale = ", scale: log" if log else ""
    return f'{name}: {{value: {_number(value)}, unit: {spelled}, source: "{source}"{fitted}{scale}}}'


def _asked(sheet: Sheet, key: str, name: str = "") -> str:
    """The entry of a question, in its own unit, with the range of what a data sheet or an assumption says."""
    question = questions()[key]
    factor = si_factor_of(question)
    value, what = sheet[key] / factor, question.what
    unit = "rad/s" if question.unit == "Hz" else question.unit
    value = value * factor if question.unit == "Hz" else value
    given = key in sheet.answers
    source = SHEET if given else what["known"]
    if "lower" in what:
        return _entry(
            name or key,
            value,
            unit,
            f"{source}; {what['known_range']}",
            (value * what["lower"], value * what["upper"]),
        )
    if "assumed_upper_share" in what:
        most = max(what["assumed_upper_share"] * sheet._whole(key) / factor, 2.0 * value)
        return _entry(name or key, value, unit, source, (0.0, most))
    spread = what["factor"] if given else what["assumed_factor"]
    limits = None if spread == 1 or value <= 0.0 else (value / spread, value * spread)
    return _entry(name or key, value, unit, source, limits)


def _kept(name: str, key: str = "") -> str:
    entry = fixed(key or name)
    return _entry(name, entry["value"], entry["unit"], entry["source"])


def rig_text(name: str, sheet: Sheet, step: float) -> str:
    """The file.

    Args:
        name: of the machine.
        sheet: what its data sheet says.
        step: longest step of the integration [s].
    """
    pump = _pump(sheet) if sheet.pump else [_kept("flow_time_constant")]
    lines = [
        "# Written by `hydrolek rig new`. A value with a range is searched by a fit; one without is taken as it is.",
        f'# Sources: "{SHEET}" is what was said; "assumed" what nobody said, with a wide range: mend it if you know.',
        "schema: 1",
        f"name: {name}",
        f"title: {name.replace('_', ' ')}",
        "",
        "integration:",
        f"  {_entry('longest_step', 1e3 * step, 'ms', 'the longest that agrees with finer ones on this machine')}",
        '  spool_steps: {value: 1, unit: "1", source: "the spool\'s step is stable at any stiffness"}',
        "",
        "recording:",
        "  initial_position: recording  # where a replay starts",
        "  # columns: {their name: joint.angle_deg}  # names of your file's columns, if they differ",
        "",
        "supply:",
        f"  variant: {'pump' if sheet.pump else 'constant_pressure'}",
        f"  {_asked(sheet, 'supply_pressure', 'pressure')}",
        f"  {_asked(sheet, 'tank_pressure')}",
        *(f"  {line}" for line in pump),
        "",
        "fluid:",
        f"  {_asked(sheet, 'oil_density', 'density')}",
        f"  {_asked(sheet, 'bulk_modulus')}",
        f"  {_kept('laminar_transition')}",
        f"  {_kept('atmospheric_pressure')}",
        "",
        "joints:",
        f"  {sheet['joint']}:",
        "    command:",
        f"      {_asked(sheet, 'delay')}",
        f"      {_asked(sheet, 'full_command', 'limit')}",
        '      # polarity: {value: -1, unit: "1", source: "..."}  # if a positive command retracts',
        "    amplifier: {variant: none}  # the valve has its own",
        "    solenoid:",
        "      variant: servo_valve",
        f"      {_asked(sheet, 'full_command', 'rated_voltage')}",
        f"      {_asked(sheet, 'spool_travel', 'full_stroke')}",
        f"      {_asked(sheet, 'bandwidth')}",
        f"      {_asked(sheet, 'spool_damping', 'damping_ratio')}",
        *(f"    {line}" for line in _valve(sheet)),
        *(f"    {line}" for line in _cylinder(sheet)),
        *(f"    {line}" for line in (_link(sheet) if sheet.turns else _slide(sheet))),
        "",
    ]
    return "\n".join(lines)


def _pump(sheet: Sheet) -> list[str]:
    return [
        _asked(sheet, "displacement"),
        _asked(sheet, "pump_speed", "speed"),
        _leak(sheet),
        _rise(sheet),
        _asked(sheet, "relief_hysteresis"),
        _asked(sheet, "relief_time"),
        _asked(sheet, "line_volume"),
        *_line_at_start(sheet),
    ]


def _line_at_start(sheet: Sheet) -> list[str]:
    """The line where a recording begins, which a fit finds: at rest, or with a pump that was just switched on."""
    bar = si_factor("bar", "Pa")
    rest = sheet["supply_pressure"] + sheet["relief_rise"]
    limits = (sheet["tank_pressure"] / bar, 1.1 * rest / bar)
    return [
        _entry("initial_pressure", rest / bar, "bar", "assumed: at rest", limits, log=False),
        _entry("initial_relief", 1.0, "1", "assumed: at rest; 0 with the valve closed", (0.0, 1.0)),
    ]


def _leak(sheet: Sheet) -> str:
    """What the pump loses for each pressure, from what it loses at the relief valve's setting."""
    question = questions()["pump_leakage"]
    at_setting = 1.0 / sheet["supply_pressure"]
    most = question.what["assumed_upper_share"] * sheet._whole("pump_leakage")
    source = SHEET if "pump_leakage" in sheet.answers else question.what["known"]
    lost = sheet["pump_leakage"]
    limits = (0.0, max(most, 2.0 * lost) * at_setting)
    return _entry("pump_leakage", lost * at_setting, "m^3/(s Pa)", source, limits, log=False)


def _rise(sheet: Sheet) -> str:
    """Slope of the relief valve, from its rise when it lets all off."""
    what = questions()["relief_rise"].what
    given = "relief_rise" in sheet.answers
    slope = sheet["relief_rise"] / (sheet["displacement"] * sheet["pump_speed"])
    spread = what["factor"] if given else what["assumed_factor"]
    return _entry(
        "relief_slope", slope, "Pa s/m^3", SHEET if given else what["known"], (slope / spread, slope * spread)
    )


def _valve(sheet: Sheet) -> list[str]:
    flow = "rated_flow" in sheet.answers
    source = (
        f"{SHEET}: {'flow at the rated drop' if flow else 'spool diameter and share of its circumference'}"
    )
    return [
        "valve:",
        "  variant: four_edges",
        f"  {_asked(sheet, 'spool_travel', 'full_opening')}",
        f"  {_asked(sheet, 'overlap', 'overlap_pa')}",
        *(f"  overlap_{edge}: {{same_as: overlap_pa}}" for edge in EDGES[1:]),
        *(
            f"  {_entry(f'area_gradient_{edge}', 1e3 * gradient, 'mm', source)}"
            for edge, gradient in sheet.gradients.items()
        ),
        f"  {_asked(sheet, 'flow_coefficient', 'discharge')}",
    ]


def _cylinder(sheet: Sheet) -> list[str]:
    return [
        "cylinder:",
        "  variant: cylinder",
        f"  {_entry('area_a', 1e6 * sheet.area_a, 'mm^2', f'{SHEET}: bore')}",
        f"  {_entry('area_b', 1e6 * sheet.area_b, 'mm^2', f'{SHEET}: bore and rod')}",
        f"  {_asked(sheet, 'dead_volume', 'dead_volume_a')}",
        "  dead_volume_b: {same_as: dead_volume_a}",
        f"  {_end(sheet, 'stroke', sheet['stroke'], SHEET)}",
        *(f"  {line}" for line in _stops(sheet)),
        f"  {_column(sheet)}",
        f"  {_at_start(sheet)}",
        f"  {_asked(sheet, 'seal_damping', 'viscous_friction')}",
        f"  {_kept('friction_velocity')}",
    ]


def _at_start(sheet: Sheet) -> str:
    """Pressure of side B at the start, which a fit finds."""
    supply, tank = sheet["supply_pressure"], sheet["tank_pressure"]
    bar = si_factor("bar", "Pa")
    limits = (max(tank, 0.02 * supply) / bar, supply / bar)
    return _entry("initial_pressure_b", 0.5 * supply / bar, "bar", "assumed: half of the supply", limits)


def _stops(sheet: Sheet) -> list[str]:
    """The piston's stops where the stroke ends; the largest force presses them in by a little."""
    depth, spread = fixed("stop_depth"), fixed("stop_depth_factor")["value"]
    stiffness = sheet.force / (depth["value"] * si_factor(depth["unit"], "m"))
    lever = sheet.lever if sheet.turns else 1.0
    moving = sheet["mass"] * (sheet["length"] / lever) ** 2 / 3.0 if sheet.turns else sheet["mass"]
    damping = math.sqrt(stiffness * moving)
    return [
        _entry("stop_stiffness", stiffness, "N/m", depth["source"], (stiffness / spread, stiffness * spread)),
        _entry(
            "stop_damping",
            damping,
            "N s/m",
            f"assumed: half of critical with the mass; {fixed('stop_depth_factor')['source']}",
            (damping / spread, damping * spread),
        ),
    ]


def _column(sheet: Sheet) -> str:
    """Compliance that an oil column has at least, as a share of that of side A in mid-stroke."""
    share, spread = fixed("column_share"), fixed("stop_depth_factor")["value"]
    volume = sheet["dead_volume"] + 0.5 * sheet["stroke"] * sheet.area_a
    least = share["value"] * volume / (sheet["bulk_modulus"] * sheet.area_a**2)
    return _entry("column_compliance", least, "m/N", share["source"], (least / spread, least * spread))


def _end(sheet: Sheet, name: str, value: float, source: str) -> str:
    """Where the stroke ends or begins [mm], to within what rods are screwed and built to."""
    spread = 1e3 * fixed("stop_place")["value"] / 100.0 * sheet["stroke"]
    return _entry(name, 1e3 * value, "mm", source, (1e3 * value - spread, 1e3 * value + spread), log=False)


def _beyond(lower: float, upper: float, unit: str, of: str) -> list[str]:
    """The load's own stops: none where the cylinder has some."""
    rim = 0.05 * (upper - lower)
    none = "none: the cylinder's own stops act"
    torque = "N m" if of == "rad" else "N"
    return [
        _entry("lower_stop", lower - rim, unit, "assumed: behind the cylinder's own stop"),
        _entry("upper_stop", upper + rim, unit, "assumed: behind the cylinder's own stop"),
        _entry("stop_stiffness", 0.0, f"{torque}/{of}", none),
        _entry("stop_damping", 0.0, f"{torque} s/{of}", none),
    ]


def _link(sheet: Sheet) -> list[str]:
    lower, upper = math.degrees(sheet.lower), math.degrees(sheet.upper)
    rim = 0.1 * (upper - lower)
    along, across = sheet.answers.get("centre", (0.5 * sheet["length"], 0.0))
    weighs = _entry("gravity", 0.0, "m/s^2", SHEET) if sheet["upright"] == "yes" else _kept("gravity")
    even = "assumed: spread evenly over the length"
    place = f"{SHEET}: place" if "centre" in sheet.answers else even
    stops = _beyond(lower, upper, "deg", "rad")
    return [
        "linkage:",
        "  variant: triangle",
        f"  {_entry('distance_parent', sheet.parent, 'm', f'{SHEET}: base mount')}",
        f"  {_entry('distance_child', sheet.child, 'm', f'{SHEET}: link mount')}",
        f"  {_entry('angle_offset', math.degrees(sheet.offset), 'deg', f'{SHEET}: mounts at joint angle zero')}",
        f"  {_entry('direction', sheet.direction, '1', f'{SHEET}: extension turns the link this way')}",
        f"  {_end(sheet, 'zero_stroke_length', sheet.zero_length, f'{SHEET}: mounts and stroke')}",
        "load:",
        "  variant: link",
        f"  {_asked(sheet, 'mass')}  # inertia and gravity follow from it and its place",
        f"  {_entry('centre_along', along, 'm', place)}",
        f"  {_entry('centre_across', across, 'm', place)}",
        f"  {_entry('gyration_radius', sheet['length'] / math.sqrt(12.0), 'm', even)}",
        f"  {weighs}",
        f"  {_asked(sheet, 'bearing_damping', 'damping')}",
        f"  {_kept('friction_velocity', 'bearing_friction_velocity')}",
        *(f"  {line}" for line in stops),
        f"  {_entry('initial_position', math.degrees(sheet['mid_stroke_at']), 'deg', 'half of the stroke')}",
        "sensor:",
        "  variant: position",
        f"  {_entry('travel_lower', lower - rim, 'deg', 'assumed: a tenth more than the stops')}",
        f"  {_entry('travel_upper', upper + rim, 'deg', 'assumed: a tenth more than the stops')}",
        f"  {_asked(sheet, 'angle_noise', 'noise')}",
        '  resolution: {value: 0, unit: deg, source: "told by the recording"}',
        f"  {_asked(sheet, 'pressure_noise')}",
    ]


def _slide(sheet: Sheet) -> list[str]:
    stroke = 1e3 * sheet["stroke"]
    return [
        "linkage:",
        "  variant: direct",
        '  zero_stroke_position: {value: 0, unit: m, source: "the position counts from the retracted end"}',
        '  direction: {value: 1, unit: "1", source: "extension counts as positive"}',
        "load:",
        "  variant: sliding",
        f"  {_asked(sheet, 'mass', 'inertia')}",
        f"  {_asked(sheet, 'guide_damping', 'damping')}",
        *(f"  {line}" for line in _beyond(0.0, stroke, "mm", "m")),
        f"  {_entry('initial_position', 0.5 * stroke, 'mm', 'half of the stroke')}",
        "sensor:",
        "  variant: position",
        f"  {_entry('travel_lower', -0.1 * stroke, 'mm', 'assumed: a tenth more than the stroke')}",
        f"  {_entry('travel_upper', 1.1 * stroke, 'mm', 'assumed: a tenth more than the stroke')}",
        f"  {_asked(sheet, 'position_noise', 'noise')}",
        '  resolution: {value: 0, unit: mm, source: "told by the recording"}',
        f"  {_asked(sheet, 'pressure_noise')}",
    ]
