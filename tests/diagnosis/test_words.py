"""Numbers as an engineer writes them."""

import pytest

from hydrolek_drake.diagnosis.words import three_digits


@pytest.mark.parametrize(
    ("value", "told"),
    [(1262.4, "1260"), (63.54, "63.5"), (0.99612, "0.996"), (999.6, "1000"), (4.56e-9, "4.56e-09")],
)
def test_three_digits_and_no_exponent_where_none_is_needed(value: float, told: str) -> None:
    assert three_digits(value) == told
