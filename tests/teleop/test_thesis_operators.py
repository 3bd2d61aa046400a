"""Table 5.4 is data, and its printed reductions follow from its times."""

import numpy as np
import pytest

from hydrolek_drake.yaml_files import package_yaml


@pytest.mark.parametrize(("who", "mean"), [("inexperienced", 81.6), ("experienced", 67.6)])
def test_reductions_of_table_5_4_follow_from_its_times(who, mean):
    row = package_yaml("hydrolek_drake.teleop", "thesis_operators.yaml")[who]
    joystick, assisted = np.array(row["joystick"]), np.array(row["assisted"])
    assert 100.0 * (1.0 - assisted / joystick) == pytest.approx(row["reduction_percent"], abs=0.06)
    assert np.mean(row["reduction_percent"]) == pytest.approx(mean, abs=0.05)
