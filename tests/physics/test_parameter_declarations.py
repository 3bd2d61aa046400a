"""What the stages declare about their parameters."""

import numpy as np
import pytest

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.physics.driven import DRIVEN
from hydrolek_drake.physics.law import LAW, MOST_TERMS
from hydrolek_drake.physics.records import JOINT, STAGES, flat, position_of
from hydrolek_drake.units import si_factor

DECLARED = [
    (stage.name, variant, p)
    for stage in STAGES.values()
    for variant in stage.variants
    for p in stage.parameters(variant)
]


@pytest.mark.parametrize("where", DECLARED, ids=lambda where: f"{where[0]}.{where[1]}.{where[2].name}")
def test_every_parameter_has_a_meaning_si_units_and_an_admissible_neutral_value(where):
    _, _, parameter = where
    assert parameter.meaning
    for unit in parameter.unit.split("|"):
        assert si_factor("1 " + unit, unit) == 1.0  # pint reads it, and it is what it says
    if parameter.neutral is not None:
        assert parameter.lowest <= parameter.neutral <= parameter.highest


def test_a_flat_record_shares_memory_and_position_of_finds_its_numbers():
    records = np.zeros(2, JOINT)
    vectors = flat(records)
    vectors[1, position_of("cylinder", "area_b")] = 6e-4
    vectors[1, position_of("load_payload", "mass_kg")] = 3.0
    assert records["cylinder"]["area_b"].tolist() == [0.0, 6e-4]
    assert records["effects"]["load_payload"]["mass_kg"].tolist() == [0.0, 3.0]
    assert vectors.shape == (
        2,
        sum(len(s.dtype().names) for s in STAGES.values())
        + sum(len(e.parameters) for e in EFFECTS.values())
        + MOST_TERMS * len(LAW.names)
        + len(DRIVEN.names),
    )
