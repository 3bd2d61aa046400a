"""A reference of four seconds: what it lacks is told, its error raises no alarm, and a fault is seen all the same."""

import pytest

from hydrolek_drake.recordings import read_recording, write_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.excitation import lacking
from hydrolek_drake.watching.page import page
from hydrolek_drake.watching.watch import watch
from hydrolek_drake.watching.words import sentences

pytestmark = [pytest.mark.xdist_group("a watched series"), pytest.mark.thorough]

SECONDS = 4.0


@pytest.fixture(scope="module")
def short_reference(references, tmp_path_factory):
    path = tmp_path_factory.mktemp("short") / "reference.csv"
    write_recording(read_recording(references[0]).between(0.0, SECONDS), path)
    return [path]


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    return tmp_path_factory.mktemp("kept")


def test_a_healthy_machine_gives_no_alarm_and_the_reference_is_told_to_be_short(
    machine_days, short_reference, kept
):
    files = sorted((machine_days / "healthy").glob("*.csv"))
    watched = watch(load_rig("joint_bench"), short_reference, files, folder=kept, cores=1)
    assert watched.alarm is None and len(watched.answers) == len(files)
    lacks = lacking(watched.told, watched.answers)
    assert lacks and all(each.deviation > each.later and each.longer > 1.0 for each in lacks)
    [told] = [line for line in sentences(watched, []) if line.startswith("The reference (")]
    assert lacks[0].path.removeprefix("joints.joint.") in told and "would tell them as surely" in told
    assert "determines these parameters less well than one later recording" in page(watched)


def test_a_leakage_is_alarmed_all_the_same(machine_days, short_reference, kept):
    """After four healthy recordings, which say what the reference does not."""
    files = [
        *sorted((machine_days / "healthy").glob("*.csv")),
        *sorted((machine_days / "leaking").glob("*.csv"))[-3:],
    ]
    watched = watch(load_rig("joint_bench"), short_reference, files, folder=kept, cores=1)
    assert watched.alarm is not None and watched.alarm.effect == "cylinder.cross_port_leakage"


def test_a_reference_that_is_long_enough_lacks_nothing_of_weight(machine_days, references):
    files = sorted((machine_days / "healthy").glob("*.csv"))[:2]
    watched = watch(load_rig("joint_bench"), references, files, cores=1)
    assert not any(each.longer > 2.0 for each in lacking(watched.told, watched.answers))
