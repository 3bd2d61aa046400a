"""How much of a recording first fits see: as much as it takes to show what is missing."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.beginning import SHOWN, shown_by
from hydrolek_drake.diagnosis.effort import GLANCE_S
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.parameter_set import free_parameters

TIME = np.arange(0.0, 60.0, 0.01)


def _shown_by(*residuals: np.ndarray, channels: int = 1, begins: float = 0.0) -> float:
    experiments = [SimpleNamespace(time=begins + TIME, channels=(None,) * channels) for _ in residuals]
    return shown_by(np.concatenate([np.tile(r, channels) for r in residuals]), experiments)


def test_an_even_error_is_seen_in_what_first_fits_see_at_least() -> None:
    assert _shown_by(np.random.default_rng(1).standard_normal(TIME.size)) == GLANCE_S


@pytest.mark.parametrize("power", [1, 2, 3])
def test_an_error_that_grows_with_time_is_seen_longer(power: int) -> None:
    """The integral of t^2p reaches a share of its whole at the share's root of order 2p + 1."""
    expected = TIME[-1] * SHOWN ** (1.0 / (2 * power + 1))
    assert _shown_by((TIME / TIME[-1]) ** power) == pytest.approx(expected, abs=0.05)


def test_an_error_that_begins_late_is_seen_whatever_else_is_recorded() -> None:
    late = np.where(TIME < 50.0, 0.01, 10.0)
    early = np.full(TIME.size, 0.01)
    for seen in (
        _shown_by(late),
        _shown_by(late, channels=3),
        _shown_by(late, begins=100.0),
        _shown_by(early, late),
    ):
        assert seen == pytest.approx(50.0 + SHOWN * 10.0, abs=0.1)


def test_fits_begin_with_what_shows_it(bench, recorded) -> None:
    workbench = Workbench(bench, free_parameters(bench), recorded(bench, bench), None)
    assert workbench.beginning()[0].time.size == workbench.training[0].time.size  # 12 s, less than GLANCE_S
    workbench.first_s = 5.0
    assert np.ptp(workbench.beginning()[0].time) == pytest.approx(5.0)
