"""A diagnosis in the words of an engineer, and its numbers as one writes them: to as many digits as are known."""

import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.laws.law import FoundLaw, amplitude_intervals, frequency_interval
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.replay.display import display_factor, display_unit, ratio, shown, three_digits
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.rig import declaration
from hydrolek_drake.rigs.parameters.declarations import unit_there


def unit_at(rig: Rig, candidate: Candidate, unit: str) -> str:
    """The unit of an effect's parameter at its joint: of a length where the load slides, of an angle where it turns."""
    return unit_there(unit, candidate.effect, f"joints.{candidate.joint}", rig.variants)


def sizes(candidate: Candidate, diagnosis: Diagnosis) -> str:
    """Every parameter of an effect with its interval."""
    told = []
    for parameter in candidate.effect.parameters:
        known = diagnosis.intervals.get(path_of(candidate, parameter))
        if known is None:
            continue
        unit = unit_at(diagnosis.rig, candidate, parameter.unit)
        value, low, high = with_interval(known, unit)
        told.append(f"{parameter.meaning} {value} (95 %: {low} to {high.partition(' ')[0]})")
    return ", ".join(told)


def path_of(candidate: Candidate, parameter: Parameter) -> str:
    """Full path of an effect's parameter."""
    return f"joints.{candidate.joint}.effects.{candidate.id}.{parameter.name}"


def effect_sentence(candidate: Candidate, diagnosis: Diagnosis) -> str:
    """What an engineer would say about one effect."""
    place = next(
        (p for p in diagnosis.locations if (p.stage, p.joint) == (candidate.effect.stage, candidate.joint)),
        None,
    )
    where = f" It shows {place.condition}." if place else ""
    return (
        f"{candidate.joint}, {candidate.effect.stage}: {candidate.effect.title}: "
        f"{sizes(candidate, diagnosis)}.{where}{_at_an_end(candidate, diagnosis)}"
    )


def _at_an_end(candidate: Candidate, diagnosis: Diagnosis) -> str:
    """That a parameter of an effect ends at an end of its range; nothing if none does."""
    ends = {free.path: free for free in candidate.ended(diagnosis.best.hypothesis.values)}
    told = []
    for parameter in candidate.effect.parameters:
        free = ends.get(path_of(candidate, parameter))
        if free is not None:
            unit = unit_at(diagnosis.rig, candidate, parameter.unit)
            told.append(f"{parameter.meaning} ({quantity(free.lower, unit)} to {quantity(free.upper, unit)})")
    if not told:
        return ""
    return f" At an end of what is searched: {_listed(told)}; something else may act like this effect."


def off_zero_sentences(diagnosis: Diagnosis) -> list[str]:
    """Parameters that the rig has at zero and the recordings have not: physics that it knows but leaves out."""
    told = []
    for path, known in diagnosis.intervals.items():
        if ".effects." in path or diagnosis.rig.value(path) != 0.0 or known.low <= 0.0 <= known.high:
            continue
        declared = declaration(diagnosis.rig, path)
        value, low, high = with_interval(known, declared.unit)
        told.append(
            f"{path.removeprefix('joints.')} is zero in the rig and {value} by the recordings "
            f"(95 %: {low} to {high}): {declared.meaning}."
        )
    return told


def behind(judged: Judged) -> str:
    """How far a structure is behind the most probable one on held-out data, with its standard error."""
    if not math.isfinite(judged.behind_error) or judged.behind_error == 0.0:
        return ""
    doubt = " ?" if abs(judged.behind) < EVIDENCE.deviations * judged.behind_error else ""
    return f"{judged.behind:.3g} \u00b1 {judged.behind_error:.2g}{doubt}"


def headline(diagnosis: Diagnosis) -> str:
    """The verdict in one sentence."""
    if diagnosis.verdict == "bad_data":
        return f"These recordings cannot be diagnosed: {diagnosis.reasons[0]}."
    best, baseline = diagnosis.best, diagnosis.baseline
    before, after = _ratio(baseline.over_noise), _ratio(best.over_noise)
    if diagnosis.verdict == "none":
        if best.fitted_too is not None:
            return (
                f"These data show nothing missing. The nominal model, with its own parameters fitted, leaves {after} "
                f"the noise where it predicts the held-out data, and {_ratio(best.fitted_too)} the noise once it is "
                f"fitted to these data too."
            )
        return (
            f"Nothing is missing: the nominal model, with its own parameters fitted, predicts the held-out data "
            f"to {after} the noise."
        )
    if diagnosis.verdict == "interrupted":
        so_far = _listed([c.effect.title for c in best.hypothesis.listed]) or "the nominal model"
        if diagnosis.law is not None:
            so_far = f"a law at the stage {diagnosis.law.law.input.stage}"
            after = _ratio(diagnosis.law.held_out_over_noise)
        return (
            f"Cut off before the search had ended: best so far is {so_far}, which leaves {after} the noise on "
            f"held-out data (nominal model: {before}). More time may change it."
        )
    names = _listed([c.effect.title for c in best.hypothesis.listed])
    stages = ", ".join(dict.fromkeys(c.effect.stage for c in best.hypothesis.listed))
    if diagnosis.verdict == "missing_physics":
        it = "it" if len(best.hypothesis.effects) == 1 else "them"
        return (
            f"Missing from the model: {names} ({stages}). With {it} the error on held-out data falls from "
            f"{before} to {after} the noise."
        )
    if diagnosis.verdict == "ambiguous":
        groups = diagnosis.conclusion.groups if diagnosis.conclusion else ()
        if not groups:
            return "Something small may be missing, but these data do not decide whether it is."
        group = " or ".join(groups[0])
        return (
            f"Something is missing, but these data cannot tell {group} apart: the most probable of them takes "
            f"the error on held-out data from {before} to {after} the noise."
        )
    if best.hypothesis.effects:
        told = (
            f"Missing from the model: {names} ({stages}), and physics that is in no list: with the former the error on "
            f"held-out data falls from {before} to {after} the noise"
        )
    else:
        told = (
            f"Physics is missing that is in no list: no known effect takes a material part of the error on held-out "
            f"data, {before} the noise"
        )
    if diagnosis.law is None:
        return f"{told}."
    law = diagnosis.law
    elsewhere = f" (a law at the {' or the '.join(law.rivals)} does nearly as well)" if law.rivals else ""
    of = f" of {law.joint}" if _several(diagnosis) else ""
    return f"{told}. At the {law.law.input.stage}{of}{elsewhere}, {law_sentence(law)}"


def _several(diagnosis: Diagnosis) -> bool:
    """Whether several joints were driven."""
    return len({experiment.joint for experiment in diagnosis.held_out}) > 1


def law_sentence(law: FoundLaw) -> str:
    """The law for physics in no list, and how well it does."""
    return f"{law.equation()} leaves {_ratio(law.held_out_over_noise)} the noise on held-out data."


def known_to(law: FoundLaw) -> str:
    """How far the numbers of a law are known; nothing for one whose numbers are each recording's own."""
    told = [with_interval(known, law.law.input.unit) for known in amplitude_intervals(law)]
    if law.law.periodic:
        told.append(with_interval(frequency_interval(law), "Hz"))
    if not told:
        return ""
    return f" 95 %: {', '.join(f'{low} to {high}' for _, low, high in told)}."


def where_sentence(law: FoundLaw) -> str:
    """What the letters of a law mean; nothing for one that has none."""
    if law.remark:
        return f" {law.remark}"
    names = " ".join(law.names)
    reach = law.span.at(law.law.input.probe)
    rod = reach is law.span.rod
    place, low, high = (
        "stroke" if rod else "position",
        shown(reach.low, reach.unit),
        shown(reach.high, reach.unit),
    )
    half = shown(reach.distance(1.0), reach.unit)
    over = f" over {shown(reach.speed, reach.unit)}/s" if "v" in names.replace("sign(v)", "") else ""
    told = {
        "t/T": f"T = {shown(law.span.seconds, 's')}",
        "z": f"z is the {place}, -1 at {low} and 1 at {high}",
        "near": f"near(c, w) is 1 at a {place} of c and falls to 0 over w to either side",
        "beyond": f"beyond(c) is 0 up to a {place} of c and grows with it, by 1 over {half}",
        "below": f"below(c) is 0 down to a {place} of c and grows as it falls further, by 1 over {half}",
        "v": f"v is the {'rod' if rod else 'joint'}'s speed{over}",
        "p_": f"p_A and p_B are pressures over {shown(law.span.pressure, 'Pa')}",
        "x": f"x is the spool over {shown(law.span.opening, 'm')}",
    }
    used = [text for letter, text in told.items() if letter in names]
    return f" Here {_listed(used)}." if used else ""


def _listed(titles: Sequence[str]) -> str:
    """Titles in a row; with semicolons, since a title may have an 'and' of its own."""
    if len(titles) < 2:
        return "".join(titles)
    joined = any(" and " in title for title in titles) or len(titles) > 2
    return "; ".join(titles) if joined else " and ".join(titles)


def _ratio(over_noise: float) -> str:
    return f"{ratio(over_noise)} times"


FULL = range(-3, 6)
"""Powers of ten of numbers that are written in full: 0.00123 and 126000, but 1.23e-04 and 1.26e+06."""

MOST_DIGITS = 7
"""Of a number whose interval is narrower than anyone reads."""


def quantity(value: float, unit: str) -> str:
    """A parameter given in SI, to three digits; of alternative units, behind a bar, the first."""
    return shown(value, unit.partition("|")[0])


def with_interval(known: Interval, unit: str) -> tuple[str, str, str]:
    """A fitted value, the lower end of its interval and the upper one, in the unit that people use.

    All three are rounded alike, so that two digits of half the interval's width are seen; a value whose interval has
    no width is told to three digits. The unit is written behind the first and the last.

    Args:
        known: in SI.
        unit: SI unit, alternatives behind a bar.
    """
    main = unit.partition("|")[0]
    factor = display_factor(main)
    value, low, high = (factor * v for v in (known.value, known.low, known.high))
    largest = max(abs(value), abs(low), abs(high))
    half = 0.5 * abs(high - low)
    if not 0.0 < half < math.inf:
        texts = [three_digits(v) for v in (value, low, high)]
    else:
        leading = _power(abs(value) if 10.0 * abs(value) > largest else largest)
        decimals = min(1 - _power(half), MOST_DIGITS - 1 - leading)
        texts = [_rounded(v, decimals, leading) for v in (value, low, high)]
    return f"{texts[0]}{_written(main)}", texts[1], f"{texts[2]}{_written(main)}"


def _written(unit: str) -> str:
    return "" if unit == "1" else f" {display_unit(unit)}"


def _power(value: float) -> int:
    return math.floor(math.log10(value))


def _rounded(value: float, decimals: int, leading: int) -> str:
    """A number to so many decimals; with this power of ten where it is no everyday one."""
    if leading in FULL:
        return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"
    return f"{round(value * 10.0**-leading, decimals + leading) + 0.0:.{max(decimals + leading, 0)}f}e{leading:+03d}"
