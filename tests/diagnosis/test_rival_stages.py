"""Stages that a law for physics in no list may stand at as well."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.gains import GAIN_NEEDED
from hydrolek_drake.diagnosis.judged import NOISE_KNOWN, flatter
from hydrolek_drake.diagnosis.unlisted import rivals_of

COUNTED, PARAMETERS = 7000, 11
AT_NOISE = COUNTED * (1.0 + NOISE_KNOWN) ** 2


def _law(stage):
    return SimpleNamespace(
        law=SimpleNamespace(input=SimpleNamespace(stage=stage)),
        fit=SimpleNamespace(unit=np.zeros(PARAMETERS)),
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
    laws = [_law("load"), _law("cylinder"), _law("load")]
    assert rivals_of(laws[0], laws, [least, least + behind, least + 1.0], COUNTED) == rivals


def test_at_the_noise_the_likelihood_is_that_of_noise() -> None:
    assert flatter(COUNTED, COUNTED, PARAMETERS) == 1.0
    assert flatter(AT_NOISE + 55.0, COUNTED, PARAMETERS) == pytest.approx(5.0)
