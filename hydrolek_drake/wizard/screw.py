"""The commented rig file of a ball screw under a servo drive, from a data sheet."""

import math

from hydrolek_drake.units import si_factor
from hydrolek_drake.wizard.entries import SHEET, asked, beginning, entry, kept
from hydrolek_drake.wizard.questions import fixed, questions
from hydrolek_drake.wizard.sheet import Sheet

_NO_OIL = "there is no oil"


def screw_text(name: str, sheet: Sheet, step: float) -> str:
    """The file.

    Args:
        name: of the machine.
        sheet: what its data sheet says.
        step: longest step of the integration [s].
    """
    nothing = f'source: "{_NO_OIL}"'
    travel = 1e3 * sheet["travel"]
    lines = [
        *beginning(name, sheet, step, "there is no spool"),
        f"  # columns: {{their name: {sheet['joint']}.current_A}}  # names of your file's columns, if they differ; the",
        f"  # set point is {sheet['joint']}.command_V, of which each volt is set_point_gain",
        "",
        "supply:",
        f"  pressure: {{value: 0, unit: Pa, {nothing}}}",
        f"  tank_pressure: {{value: 0, unit: Pa, {nothing}}}",
        f"  flow_time_constant: {{value: 1, unit: s, {nothing}}}",
        "fluid:",
        f"  density: {{value: 1, unit: kg/m^3, {nothing}}}",
        f"  bulk_modulus: {{value: 1, unit: Pa, {nothing}}}",
        f"  laminar_transition: {{value: 1, unit: Pa, {nothing}}}",
        f"  {kept('atmospheric_pressure')}",
        "",
        "joints:",
        f"  {sheet['joint']}:",
        "    command:",
        f"      {asked(sheet, 'delay')}",
        f"      {entry('limit', 1.1 * sheet['travel'] / sheet['set_point'], 'V', 'a tenth beyond the travel')}",
        "    amplifier: {variant: none}  # within the drive",
        "    solenoid: {variant: none}",
        "    valve: {variant: none}",
        *(f"    {line}" for line in _drive(sheet)),
        "    linkage:",
        "      variant: direct",
        '      zero_stroke_position: {value: 0, unit: m, source: "the position counts as the set point does"}',
        '      direction: {value: 1, unit: "1", source: "a higher set point counts as positive"}',
        "    load:",
        "      variant: sliding",
        f"      {asked(sheet, 'mass', 'inertia')}",
        f"      {_pushing(sheet)}",
        f"      {asked(sheet, 'guide_damping', 'damping')}",
        f"      {entry('lower_stop', -0.1 * travel, 'mm', 'none: the drive stays within the travel')}",
        f"      {entry('upper_stop', 1.1 * travel, 'mm', 'none: the drive stays within the travel')}",
        f"      {entry('stop_stiffness', 0.0, 'N/m', 'none: the drive stays within the travel')}",
        f"      {entry('stop_damping', 0.0, 'N s/m', 'none: the drive stays within the travel')}",
        f"      {entry('initial_position', 0.5 * travel, 'mm', 'half of the travel')}",
        f"      {kept('friction_velocity', 'screw_friction_velocity')}",
        "    sensor:",
        "      variant: position",
        f"      {entry('travel_lower', -0.1 * travel, 'mm', 'assumed: a tenth more than the travel')}",
        f"      {entry('travel_upper', 1.1 * travel, 'mm', 'assumed: a tenth more than the travel')}",
        f"      {asked(sheet, 'position_noise', 'noise')}",
        '      resolution: {value: 0, unit: mm, source: "told by the recording"}',
        f"      {asked(sheet, 'current_noise')}",
        f"      {_at_rest(sheet)}",
        f"      {entry('current_size', float(sheet['current_reads'] == 'size'), '1', _said(sheet, 'current_reads'))}",
        "    effects:",
        *(f"      {line}" for line in _friction(sheet)),
        "",
    ]
    return "\n".join(lines)


def _said(sheet: Sheet, key: str) -> str:
    return SHEET if key in sheet.answers else "assumed: as most drives have it"


def _drive(sheet: Sheet) -> list[str]:
    return [
        "cylinder:",
        "  variant: servo_screw",
        f"  {entry('set_point_gain', 1e3 * sheet['set_point'], 'mm/V', _set_point(sheet))}",
        f"  {asked(sheet, 'position_gain')}",
        f"  {asked(sheet, 'position_time')}",
        f"  {asked(sheet, 'top_speed', 'speed_limit')}",
        *(f"  {line}" for line in _speed_loop(sheet)),
        f"  {asked(sheet, 'peak_current', 'current_limit')}",
        f"  {asked(sheet, 'torque_constant')}",
        f"  {asked(sheet, 'lead')}",
        f"  {asked(sheet, 'efficiency')}",
        f"  {asked(sheet, 'rotor_inertia')}",
    ]


def _set_point(sheet: Sheet) -> str:
    return SHEET if "set_point" in sheet.answers else str(questions()["set_point"].what["known"])


def _speed_loop(sheet: Sheet) -> list[str]:
    """Gain and integral time of the speed controller, from its bandwidth and what it accelerates.

    With a gain K_n the loop of a mass m is k K_n/m fast, k newtons for each ampere; the integral is slower by a factor
    of some (symmetrical optimum: 4).
    """
    given = "speed_bandwidth" in sheet.answers
    what = questions()["speed_bandwidth"].what
    spread = what["factor"] if given else what["assumed_factor"]
    source = f"{SHEET if given else what['known']}, of the mass that the motor moves with its rotor"
    gain = sheet["speed_bandwidth"] * sheet.moved / sheet.per_amp
    loop = [entry("speed_gain", gain, "A s/m", source, (gain / spread, gain * spread))]
    if "speed_time" in sheet.answers:
        return [*loop, asked(sheet, "speed_time")]
    slower = fixed("speed_time_over_bandwidth")
    time = 1e3 * slower["value"] / sheet["speed_bandwidth"]
    return [*loop, entry("speed_time", time, "ms", slower["source"], (time / spread, time * spread))]


def _friction(sheet: Sheet) -> list[str]:
    """Friction that the healthy machine has: at the nut, that of a torque T is 2 pi T/lead."""
    given = "drag_torque" in sheet.answers
    what = questions()["drag_torque"].what
    spread = what["factor"] if given else what["assumed_factor"]
    force = 2.0 * math.pi / sheet["lead"] * sheet["drag_torque"]
    more, fades = fixed("screw_stribeck"), fixed("screw_stribeck_velocity")
    factor = si_factor(fades["unit"], "m/s")
    least, most = (share * force for share in more["range"])
    slow, fast = (speed * factor for speed in fades["range"])
    limits = (force / spread, force * spread)
    return [
        "load.stribeck_friction:",
        f"  {entry('force_N', force, 'N', SHEET if given else what['known'], limits)}",
        f"  {entry('stribeck_N', more['value'] * force, 'N', more['source'], (least, most))}",
        "  "
        + entry("stribeck_velocity_m_per_s", fades["value"] * factor, "m/s", fades["source"], (slow, fast)),
    ]


def _pushing(sheet: Sheet) -> str:
    """A constant force against the positive direction."""
    given = "pushed_by" in sheet.answers
    value, what = sheet["pushed_by"], questions()["pushed_by"].what
    most = what["spread_share"] * (abs(value) if given else sheet.force)
    limits = (value - most, value + most)
    return entry("gravity_cos", value, "N", SHEET if given else what["known"], limits, log=False)


def _at_rest(sheet: Sheet) -> str:
    """Reading of the current without a force."""
    given = "current_at_rest" in sheet.answers
    value, what = sheet["current_at_rest"], questions()["current_at_rest"].what
    most = what["spread_share"] * sheet["peak_current"]
    source = SHEET if given else what["known"]
    if sheet["current_reads"] == "size":
        return entry("current_offset", value, "A", source, (max(value - most, 0.0), value + most), log=False)
    return entry("current_offset", value, "A", source, (value - most, value + most), log=False)
