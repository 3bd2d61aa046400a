"""Which laws are tried, and which of the first fits go on."""

import numpy as np

from hydrolek_drake.diagnosis.law_problem import Law
from hydrolek_drake.diagnosis.laws import Input, Term
from hydrolek_drake.diagnosis.unlisted import FITTED, TRIED, followed, worth_trying

CONSTANT, GROWING = Term(()), Term((), time="t/T")


def _law(probe: str, term: Term | None, gain: float = 1.0) -> Law:
    terms = () if term is None else (term,)
    return Law(Input("valve", probe, "", "1", 1.0), terms, 0.0 if terms else 1.7, gain, (0.1,))


def _begun(*fits: tuple[str, float]):
    return [(_law(probe, CONSTANT), (left, {}, np.zeros(1))) for probe, left in fits]


def test_a_constant_is_tried_where_an_input_says_how_the_machine_is_built() -> None:
    louder = [_law("supply", GROWING, 90.0 - n) for n in range(2 * TRIED)]
    quiet = [_law("back_a", GROWING, 9.0), _law("back_a", CONSTANT, 2.0), _law("supply", CONSTANT, 1.0)]
    tried = worth_trying([*louder, *quiet])
    assert len(tried) == TRIED
    assert [law.input.probe for law in tried[:3]] == ["supply", "back_a", "back_a"]
    assert tried[2].terms == (CONSTANT,)
    assert quiet[2] not in tried


def test_one_law_of_every_input_goes_on_where_first_fits_are_not_told_apart() -> None:
    best = _begun(*[("load", 1000.0 + n) for n in range(FITTED)])
    rest = _begun(("load", 1090.0), ("back_a", 1095.0), ("back_a", 1096.0), ("valve", 1105.0))
    assert followed([*best, *rest]) == [*best, rest[1]]
    assert followed(best[:2]) == best[:2]
