"""Commands that got lost, as an unknown input that undoes the command for a while."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from hydrolek_drake.diagnosis.laws.inputs import inputs_of
from hydrolek_drake.diagnosis.locating.unknown_input import unknown_inputs
from hydrolek_drake.diagnosis.lost_commands.share import share_lost
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

LOST_S = [(2.6, 2.9), (6.1, 6.35)]


@pytest.fixture
def share_of(bench, recorded, fitted):
    """(how it was recorded) -> share of what is left that lost commands would take."""

    def make(**how) -> float:
        training = recorded(bench, bench, **how)
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool)
            nominal = fitted(workbench, rounds=0)
            scales = natural_scales(bench, "joint", training)
            inputs = inputs_of(scales, bench.value("supply.pressure"), 10.0, "rad")
            wanted = [i for i in inputs if i.probe == "command"]
            [unknown] = unknown_inputs(workbench, nominal, nominal.values, wanted, 0.3, 2).unknowns
        return share_lost(unknown, training, 0.0, sum(e.counted for e in training))

    return make


def test_lost_commands_take_most_of_what_they_leave(share_of) -> None:
    assert share_of(lost_s=LOST_S) > 0.7


def test_a_machine_that_lacks_nothing_has_lost_no_commands(share_of) -> None:
    assert share_of() == 0.0


def test_a_machine_that_is_shaken_has_lost_no_commands(share_of) -> None:
    assert share_of(unknown=("load", 60.0), unknown_Hz=1.3) < 0.5
