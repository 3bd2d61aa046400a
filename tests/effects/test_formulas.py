"""Every effect has an equation that can be drawn, and says what to look at on the machine."""

import re

import pytest
from latex2mathml.converter import convert

from hydrolek_drake.effects import EFFECTS, Effect


def _letters(latex: str) -> set[str]:
    """Names of a formula without commands, subscripts that are words, and e, the base of the logarithm."""
    plain = re.sub(r"\\mathrm\{\w+\}", "", latex)
    plain = re.sub(r"\\(left|right|frac|tanh|sqrt|quad|ddot|dot|le|ge|[,;])(?![a-z])", " ", plain)
    return set(re.findall(r"\\[A-Za-z]+|[A-Za-z]", plain)) - {"e"}


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=lambda effect: effect.id)
def test_an_effect_has_a_formula_whose_letters_are_all_explained(effect: Effect) -> None:
    formula = effect.formula
    assert formula is not None
    assert set(formula.symbols) == {p.name for p in effect.parameters}
    explained = [*formula.symbols.values(), *formula.letters]
    assert all(letter in formula.latex for each in explained for letter in each.split(", "))
    assert _letters(formula.latex) <= set().union(*map(_letters, explained))
    drawn = convert(formula.latex)
    assert drawn.startswith("<math") and "\\" not in drawn


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=lambda effect: effect.id)
def test_an_effect_says_in_one_sentence_what_to_look_at(effect: Effect) -> None:
    assert re.fullmatch(r"[A-Z][^.!?]{30,180}\.", effect.inspect)
