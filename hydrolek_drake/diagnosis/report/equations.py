"""The equation of a named effect, drawn: MathML, which every browser draws without a network."""

import html

from latex2mathml.converter import convert

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.report.engineers_units import in_engineers_units
from hydrolek_drake.diagnosis.report.words import path_of, unit_at, with_interval
from hydrolek_drake.diagnosis.structures.candidates import Candidate


def drawn(latex: str, *, block: bool = False) -> str:
    """A formula as MathML.

    Args:
        latex: in LaTeX's mathematics.
        block: on a line of its own.
    """
    return convert(latex, display="block" if block else "inline")


def equation_of(candidate: Candidate, diagnosis: Diagnosis) -> str:
    """An effect's equation with its letters, and what the recordings say of those that were fitted, as HTML.

    Args:
        candidate: an effect of the best structure.
        diagnosis: the outcome.
    """
    formula = candidate.effect.formula
    if formula is None:
        return f"<p class='equation'>{html.escape(candidate.effect.equation)}</p>"
    rows = []
    for parameter in candidate.effect.parameters:
        letter, meaning = drawn(formula.symbols[parameter.name]), html.escape(parameter.meaning)
        known = diagnosis.intervals.get(path_of(candidate, parameter))
        if known is None:
            rows.append(f"<dt>{letter}</dt><dd>{meaning}</dd>")
            continue
        value, low, high = with_interval(known, unit_at(diagnosis.rig, candidate, parameter.unit))
        usual = in_engineers_units(diagnosis.rig, candidate, parameter, known)
        also = f"<br>= {html.escape(usual)}" if usual else ""
        rows.append(
            f"<dt>{letter}</dt><dd><b>{html.escape(value)}</b> "
            f"({html.escape(low)} to {html.escape(high.partition(' ')[0])}){also}<br>{meaning}</dd>"
        )
    for letters, meaning in formula.letters.items():
        listed = ", ".join(drawn(letter) for letter in letters.split(", "))
        rows.append(f"<dt>{listed}</dt><dd>{html.escape(meaning)}</dd>")
    return f"<div class='equation'>{drawn(formula.latex, block=True)}</div><dl>{''.join(rows)}</dl>"
