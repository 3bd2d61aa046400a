"""The prior of the rig's own numbers: close in fits by a fast observer, let go as it slows down."""

from concurrent.futures import ThreadPoolExecutor
from math import inf

import numpy as np
import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.settings import FITS, Rung
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Workbench, prior_spread
from hydrolek_drake.identification.parameter_set import free_parameters


def test_the_slowest_observer_and_free_rollouts_have_the_spread_of_the_ranges() -> None:
    spreads = [prior_spread(t) for t, _ in sorted(FITS.horizons) if t < inf]
    assert spreads == sorted(spreads)
    assert spreads[0] < 0.1 * SPREAD
    assert spreads[-1] == prior_spread(None) == SPREAD


def test_what_is_poorly_told_stays_where_the_rig_has_it_while_the_model_lacks_something(
    bench, recorded
) -> None:
    """A load that was picked up bends numbers; those that it leaves free stay nearer with the closer prior."""
    training = recorded(bench.with_values({"effects.load.payload.mass_kg": 60.0}), bench)
    free = free_parameters(bench)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free, training, pool)
        own = workbench.parameters(()).unit({})
        off = {
            observer_s: np.linalg.norm(
                race(workbench, [Entrant((), {})], (Rung(observer_s, 1.0, inf, 20, 1),))[0].fit.unit - own
            )
            for observer_s in (FITS.horizons[0][0], inf)
        }
    assert off[FITS.horizons[0][0]] < off[inf]
    assert off[FITS.horizons[0][0]] > 0.0


@pytest.mark.parametrize("observer_s", [0.01, 0.2, 5.0])
def test_no_observer_lets_numbers_go_further_than_their_ranges_do(observer_s: float) -> None:
    assert 0.0 < prior_spread(observer_s) <= SPREAD
