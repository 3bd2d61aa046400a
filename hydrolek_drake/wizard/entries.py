"""Lines of a rig file: value, unit, source and the range in which a fit searches."""

from hydrolek_drake.wizard.questions import fixed, questions
from hydrolek_drake.wizard.sheet import Sheet, si_factor_of

SHEET = "data sheet"
"""Source of what was said."""


def _number(value: float) -> str:
    """As YAML reads it as a number."""
    text = f"{value:.5g}"
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


def entry(
    name: str,
    value: float,
    unit: str,
    source: str,
    limits: tuple[float, float] | None = None,
    log: bool = True,
) -> str:
    """One line of a rig.

    Args:
        name: of the number.
        value: in its unit.
        unit: as it is written.
        source: of the value.
        limits: in which a fit searches; None for a number that is taken as it is.
        log: whether it is searched by its logarithm, where it cannot be zero.
    """
    log = log and limits is not None and limits[0] > 0.0
    fitted = f", range: [{_number(limits[0])}, {_number(limits[1])}]" if limits else ""
    spelled = f'"{unit}"' if unit in ("1", "%") else unit
    scale = ", scale: log" if log else ""
    return f'{name}: {{value: {_number(value)}, unit: {spelled}, source: "{source}"{fitted}{scale}}}'


def asked(sheet: Sheet, key: str, name: str = "") -> str:
    """The entry of a question, in its own unit, with the range of what a data sheet or an assumption says."""
    question = questions()[key]
    factor = si_factor_of(question)
    value, what = sheet[key] / factor, question.what
    unit = "rad/s" if question.unit == "Hz" else question.unit
    value = value * factor if question.unit == "Hz" else value
    given = key in sheet.answers
    source = SHEET if given else what["known"]
    if "lower" in what:
        return entry(
            name or key,
            value,
            unit,
            f"{source}; {what['known_range']}",
            (value * what["lower"], value * what["upper"]),
        )
    if "assumed_upper_share" in what:
        most = max(what["assumed_upper_share"] * sheet.whole(key) / factor, 2.0 * value)
        return entry(name or key, value, unit, source, (0.0, most))
    spread = what["factor"] if given else what["assumed_factor"]
    limits = None if spread == 1 or value <= 0.0 else (value / spread, value * spread)
    return entry(name or key, value, unit, source, limits)


def beginning(name: str, sheet: Sheet, step: float, spool_steps: str) -> list[str]:
    """How every rig file that is written begins.

    Args:
        name: of the machine.
        sheet: what its data sheet says.
        step: longest step of the integration [s].
        spool_steps: why one step of the spool is enough.
    """
    return [
        "# Written by `hydrolek rig new`. A value with a range is searched by a fit; one without is taken as it is.",
        f'# Sources: "{SHEET}" is what was said; "assumed" what nobody said, with a wide range: mend it if you know.',
        "schema: 1",
        f"name: {name}",
        f"title: {name.replace('_', ' ')}",
        "",
        "integration:",
        f"  {entry('longest_step', 1e3 * step, 'ms', 'the longest that agrees with finer ones on this machine')}",
        f'  spool_steps: {{value: 1, unit: "1", source: "{spool_steps}"}}',
        f"  {asked(sheet, 'model_error')}",
        f"  {kept('time_error')}",
        "",
        "recording:",
        "  initial_position: recording  # where a replay starts",
    ]


def kept(name: str, key: str = "") -> str:
    """The entry of a number that no data sheet has, as `questions.yaml` has it, with its range if it has one."""
    known = fixed(key or name)
    limits = tuple(known["range"]) if "range" in known else None
    return entry(
        name, known["value"], known["unit"], known["source"], limits, log=known.get("scale") == "log"
    )
