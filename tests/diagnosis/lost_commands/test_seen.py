"""Windows in which commands got lost, read from an unknown input that undoes the command for a while."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from hydrolek_drake.diagnosis.locating.lost_windows_seen import lost_seen
from hydrolek_drake.diagnosis.lost_commands.search import with_windows
from hydrolek_drake.diagnosis.structures.inputs import inputs_of
from hydrolek_drake.diagnosis.structures.lost_windows import recording_of
from hydrolek_drake.diagnosis.structures.term_forms import span_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

LOST_S = [(2.6, 2.9), (6.1, 6.35)]


def _lost_in(bench, workbench, nominal):
    """What is seen of lost commands beside a structure."""
    inputs = inputs_of(
        natural_scales(bench, "joint", workbench.training), bench.value("supply.pressure"), 10.0, "rad"
    )
    [command] = [i for i in inputs if i.probe == "command"]
    signals = workbench.training[0].simulate(bench.records()).signals
    span = span_of([signals], bench.records()[0], 12.0, "rad")
    return lost_seen(workbench, nominal, command, 0.0, {}, span)


@pytest.fixture
def seen_in(bench, recorded, fitted):
    """(how it was recorded) -> the recording, and what is seen of lost commands beside the rig's own numbers."""

    def make(**how):
        training = recorded(bench, bench, **how)
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
            nominal = fitted(workbench, rounds=0)
            return training[0], _lost_in(bench, workbench, nominal)

    return make


def test_lost_commands_are_seen_where_they_were_and_take_most_of_what_they_leave(seen_in) -> None:
    recording, lost = seen_in(lost_s=LOST_S)
    assert lost is not None and lost.share > 0.7
    windows = lost.seen[recording_of(recording)]
    for begin, end in LOST_S:
        middles = windows.mean(axis=1)
        assert np.any((middles > begin) & (middles < end))


def test_a_machine_that_lacks_nothing_has_lost_no_commands(seen_in) -> None:
    _, lost = seen_in()
    assert lost is None


@pytest.mark.long("half a minute: windows are fitted")
def test_a_machine_that_is_shaken_has_lost_no_commands(bench, recorded, fitted) -> None:
    """Many windows imitate anything a little: what counts is that none explain it to the noise."""
    training = recorded(bench, bench, unknown=("load", 60.0), unknown_Hz=1.3)
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
        nominal = fitted(workbench)
        lost = _lost_in(bench, workbench, nominal)
        assert lost is None or with_windows(workbench, nominal, lost) == []
