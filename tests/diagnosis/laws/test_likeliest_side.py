"""On which side of the linkage a law is named that would do as well on the other one."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.laws.found import likeliest_side
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.term_forms import Term

RUBS, PUSHES = Term((), speed="sign(v)"), Term((), place="z")
LEFT = 1000.0


def _judged(stage: str, form: Term | None, left: float) -> Judged:
    term = LawTerm(Input(stage, stage, "force", "N", 1.0), form, "joint", None)
    hypothesis = SimpleNamespace(effects=(term,), fit=SimpleNamespace(objective=0.5 * left))
    return Judged(hypothesis, np.full(1, np.sqrt(0.5 * left)), 1)


@pytest.mark.parametrize(
    ("first", "second", "behind", "stage"),
    [
        (("load", RUBS), ("cylinder", RUBS), 0.9, "cylinder"),
        (("cylinder", PUSHES), ("load", PUSHES), 0.9, "load"),
        (("cylinder", None), ("load", None), 0.9, "load"),  # a shaking
        (("cylinder", RUBS), ("load", RUBS), 0.9, "cylinder"),
        (("load", RUBS), ("cylinder", PUSHES), 0.9, "load"),
        (
            ("load", RUBS),
            ("cylinder", RUBS),
            1.1,
            "load",
        ),  # told apart by more than the noise is uncertain by
        (("supply", PUSHES), ("load", PUSHES), 0.9, "supply"),
    ],
)
def test_a_friction_is_named_at_the_rod_and_what_pushes_or_shakes_at_the_load(
    first, second, behind, stage
) -> None:
    judged = [_judged(*first, LEFT), _judged(*second, LEFT * (1.0 + behind * 2.0 * NOISE.known))]
    assert likeliest_side(judged).hypothesis.effects[0].input.stage == stage
