"""Stages that a law for physics in no list may stand at as well."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.effort import NOISE_KNOWN
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED
from hydrolek_drake.diagnosis.judged import flatter
from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_naming import likeliest
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law
from hydrolek_drake.diagnosis.laws import Term

COUNTED, PARAMETERS = 7000, 11
RUBS, PUSHES = Term((), speed="sign(v)"), Term((), place="z")
AT_NOISE = COUNTED * (1.0 + NOISE_KNOWN) ** 2


def _law(stage, *terms):
    return FoundLaw(
        Law(Input(stage, stage, "", "", 1.0), terms, 0.0, 0.0, ()),
        np.zeros(len(terms)),
        {},
        SimpleNamespace(unit=np.zeros(PARAMETERS)),
        1.0,
        np.zeros(0),
        None,
        (),
        "joint",
    )


@pytest.mark.parametrize(
    ("least", "behind", "rivals"),
    [
        (AT_NOISE, 0.9 * GAIN_NEEDED, ("cylinder",)),
        (AT_NOISE, 1.1 * GAIN_NEEDED, ()),
        # 11 parameters and 110 left beyond the noise: everything counts a tenth
        (AT_NOISE + 110.0, 9.0 * GAIN_NEEDED, ("cylinder",)),
        (AT_NOISE + 110.0, 11.0 * GAIN_NEEDED, ()),
    ],
)
def test_a_stage_is_told_beside_another_where_little_more_is_left_there(least, behind, rivals) -> None:
    laws = [_law("load", RUBS), _law("cylinder", PUSHES), _law("load", RUBS)]
    told = likeliest(laws, [least, least + behind, least + 1.0], COUNTED)
    assert told.law is laws[0].law and told.rivals == rivals


@pytest.mark.parametrize(
    ("terms", "behind", "stages"),
    [
        ({"load": RUBS, "cylinder": RUBS}, 0.9, ("cylinder", "load")),
        ({"load": RUBS, "cylinder": PUSHES}, 0.9, ("load", "cylinder")),
        ({"load": PUSHES, "cylinder": PUSHES}, 0.9, ("load", "cylinder")),
        ({"cylinder": PUSHES, "load": PUSHES}, 0.9, ("load", "cylinder")),
        ({"cylinder": PUSHES, "load": PUSHES}, 1.1, ("cylinder",)),
        ({"cylinder": RUBS, "load": RUBS}, 0.9, ("cylinder", "load")),
    ],
)
def test_of_two_that_do_as_well_a_friction_is_named_at_the_rod_and_what_pushes_at_the_load(
    terms, behind, stages
) -> None:
    laws = [_law(stage, term) for stage, term in terms.items()]
    told = likeliest(laws, [AT_NOISE, AT_NOISE + behind * GAIN_NEEDED], COUNTED)
    assert (told.law.input.stage, *told.rivals) == stages


@pytest.mark.parametrize(("share", "stages"), [(0.9, ("cylinder", "load")), (1.1, ("load",))])
def test_two_frictions_are_told_apart_only_by_more_than_the_noise_is_uncertain_by(share, stages) -> None:
    """Neither short law is quite the friction's own form, and what that leaves is hidden in the noise."""
    behind = share * 2.0 * NOISE_KNOWN * AT_NOISE
    assert behind > GAIN_NEEDED
    told = likeliest([_law("load", RUBS), _law("cylinder", RUBS)], [AT_NOISE, AT_NOISE + behind], COUNTED)
    assert (told.law.input.stage, *told.rivals) == stages
    elsewhere = likeliest(
        [_law("sensor", RUBS), _law("cylinder", RUBS)], [AT_NOISE, AT_NOISE + behind], COUNTED
    )
    assert (elsewhere.law.input.stage, elsewhere.rivals) == ("sensor", ())


def test_a_shaking_is_named_at_the_load_of_a_vane() -> None:
    laws = [_law("cylinder"), _law("load")]
    told = likeliest(laws, [AT_NOISE, AT_NOISE + 1.0], COUNTED)
    assert (told.law.input.stage, told.rivals) == ("load", ("cylinder",))


def test_at_the_noise_the_likelihood_is_that_of_noise() -> None:
    assert flatter(COUNTED, COUNTED, PARAMETERS) == 1.0
    assert flatter(AT_NOISE + 55.0, COUNTED, PARAMETERS) == pytest.approx(5.0)
