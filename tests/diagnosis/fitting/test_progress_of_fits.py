"""What is tried, what is best so far and how long it may take are told while structures are fitted."""

import math
import re
from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.progress import Progress
from hydrolek_drake.diagnosis.settings import Rung
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.fit.standing import Standing
from hydrolek_drake.identification.parameter_set import free_parameters

RUNGS = (Rung(math.inf, 2.0, math.inf, 2, 1), Rung(math.inf, 1.0, math.inf, 3, 1))


def _clock(step: float):
    """A clock on which so much passes whenever it is asked."""
    now = [0.0]

    def tell() -> float:
        now[0] += step
        return now[0]

    return tell


def test_the_time_a_rung_may_take_is_what_its_rounds_took_times_those_left() -> None:
    told: list[str] = []
    progress = Progress(told.append, _clock(4.0))
    before_round = progress.rounds(["a", "a", "b"], RUNGS, 1, lambda: None)
    before_round()
    progress.reached("a", 3.21)
    progress.reached("b", 9.0)
    before_round()
    assert told[0] == "2 models (a first), pass 2 of 2, iteration 1 of at most 3"
    # one of three rounds took 4 s
    assert told[1] == (
        "2 models (a first), pass 2 of 2, iteration 2 of at most 3, at most about 8 s more; "
        "best so far: a, 3.21 times the noise"
    )
    progress.anew()
    before_round()
    assert "best so far" not in told[2]


def test_what_ends_the_fits_ends_them_before_anything_is_told() -> None:
    told: list[str] = []

    def ended() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Progress(told.append).rounds(["a"], RUNGS, 0, ended)()
    assert told == []


def test_a_race_tells_every_round_and_what_is_best(bench, recorded) -> None:
    told: list[str] = []
    training = [e.until(3.0) for e in recorded(bench, bench)]
    with ThreadPoolExecutor(1) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, progress=Progress(told.append))
        race(workbench, [Entrant((), {"supply.pressure": 1.05 * bench.value("supply.pressure")})], RUNGS)
    assert told and all(
        re.match(r"nominal model, pass [12] of 2, iteration \d of at most [23]", t) for t in told
    )
    assert "best so far: nominal model" in told[-1] and "pass 2" in told[-1]


def test_a_search_with_a_budget_tells_how_long_the_rest_may_take_and_another_what_ends_it() -> None:
    told: list[str] = []
    standing = Standing(1000, told.append, _clock(2.0))
    standing.told(100, 0.5)  # of these, some may be an earlier run's
    standing.told(200, 0.25)
    assert told == [
        "100 simulations of at most 1000, best so far 0.5",
        "200 simulations of at most 1000, best so far 0.25; at most about 16 s more",
    ]
    Standing(None, told.append).told(40, 1.5)
    assert told[-1].startswith("40 simulations, best so far 1.5 times the noise; it ends where")
