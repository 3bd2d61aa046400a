"""A little of each target, with seeds; failures that were found before; and the runner itself."""

import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from fuzzing import runner
from fuzzing.target import Input, judged, put
from fuzzing.targets import NAMES, TRAP, target_named
from fuzzing.trap_target import WAYS

SEED = 47
APART = ("mat", "mcap", "db3", "bag", "mdf")
"""Read in a process of its own, which takes half a second to begin."""

INPUTS = (
    dict.fromkeys(NAMES, 80)
    | dict.fromkeys(APART, 3)
    | {"mat73": 30, "scenario": 40, "link": 60, "console": 30}
)


@pytest.fixture(scope="module", autouse=True)
def _no_threads_are_left():
    yield
    if "fuzzing.console_targets" in sys.modules:
        target_named("console").end()


@pytest.mark.parametrize("name", NAMES)
def test_good_inputs_are_read(name, tmp_path):
    target = target_named(name)
    target.prepare(tmp_path)
    for seed in target.seeds():
        assert judged(target, put(seed, tmp_path)) not in ("refused", "refused and refused")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", NAMES)
def test_damaged_inputs_are_read_or_refused_in_one_line(name, tmp_path):
    target = target_named(name)
    became = set()
    for index in range(INPUTS[name]):
        folder = tmp_path / str(index)
        folder.mkdir()
        target.prepare(folder)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            became.add(judged(target, put(target.input(SEED, index), folder)))
    assert became & {"refused", "refused and refused"}
    assert len(became) > 1 or name in APART  # some are good enough to be read: the damage is not too much


@pytest.mark.parametrize("name", NAMES)
def test_an_input_is_made_again_from_its_number(name):
    target = target_named(name)
    for index in (0, 3):
        assert target.input(SEED, index) == target.input(SEED, index)
    assert target.input(SEED, 0) != target.input(SEED + 1, 0)


STEPS = "schema: 1\nrig: joint_bench\nduration: 3 s\ncommand:\n  kind: steps\n  joints: {joint: [%s]}\n"
LINEAR = (
    "alpha: [0.14, 0.13, -0.1, 0.1]\nbeta: [%s, -1.1, 0.2, 1.0, -2.6, 3.0]\nsample_s: %s\ndelay_samples: %s\n"
    "range_deg: [-60, 60]\n"
)
EXPONENTIAL = "alpha: [-0.18, 0.62, %s, 1.05, 0.98, 1.05]\ndelay_samples: 6\nrange_deg: [-10, 60]\n"
HOME = "-20,20,-20,20,-20,0,40,20,20,-20,-20,-20,0,40"

FOUND = {
    "a command that changes twice within a nanosecond": (
        "scenario",
        STEPS % "[5.0e-324, 0], [1, 1 V]",
        "read",
    ),
    "a plant step that is none": (
        "scenario",
        STEPS % "[1, 1 V]" + "integration: {plant_step: 5.0e-324}\n",
        "refused",
    ),
    "a setting whose name is true": (
        "scenario",
        STEPS % "[1, 1 V]" + "settings: {true: 12 MPa}\n",
        "refused",
    ),
    "a dead time of thirty years": (
        "scenario",
        STEPS % "[1, 1 V]" + "settings: {command.delay: 1.0e+9 s}\n",
        "not run",
    ),
    "effects that make a dead time negative": (
        "scenario",
        STEPS % "[1, 1 V]" + "settings: {joints.joint.effects.command.delay.delay_s: -1 s}\n",
        "not run",
    ),
    "a joint that weighs nothing": (
        "scenario",
        STEPS % "[1, 1 V]" + "settings: {load.inertia: 1.0e-300}\n",
        "not run",
    ),
    "a step of the rollout of a nanosecond": (
        "scenario",
        STEPS % "[1, 1 V]" + "settings: {integration.longest_step: 1.0e-9}\n",
        "refused",
    ),
    "a merge key as a value": ("design", "alpha: <<\n", "refused"),
    "a dead time of 6e300 samples": ("design", LINEAR % (-0.2, 0.01, "6.0e+300"), "refused"),
    "a dead time of six seconds": ("design", LINEAR % (-0.2, 1.05, 6), "refused"),
    "a positive rate that is next to nothing": (
        "design",
        (LINEAR % (-0.2, 0.01, 6)).replace("-1.1, 0.2", "-1.1, 5.0e-324"),
        "refused",
    ),
    "samples that take no time": ("design", LINEAR % (-0.2, "1.0e-300", 6), "refused"),
    "a negative rate that is positive": ("design", LINEAR % (1.05, 0.01, 6), "refused"),
    "samples without time between them": ("design", LINEAR % (-0.2, "0.0", 6), "refused"),
    "a dead-zone that swallows what is beyond it": ("design", EXPONENTIAL % "-1.0e+300", "refused"),
    "ten written as 1_0 moves no joint": ("link", "C" + HOME.replace("20", "1_0", 1) + "\n", "refused"),
    "a word that only begins with RATE": ("link", "ORATEX," + ",".join(["1"] * 14) + "\n", "refused"),
}


@pytest.mark.parametrize(("name", "text", "became"), FOUND.values(), ids=FOUND.keys())
def test_what_fuzzing_has_found(name, text, became, tmp_path):
    target = target_named(name)
    named = target.seeds()[0].name
    assert judged(target, put(Input(named, text.encode()), tmp_path)) == became


def test_the_runner_notices_every_way_to_fail_and_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(runner, "HANG_S", 2.0)
    target = target_named(TRAP)
    seed = next(seed for seed in range(1000) if _first_ways(target, seed) == set(WAYS))
    outcome = runner.run(TRAP, seed, count=len(WAYS), kept_in=tmp_path)
    assert outcome.inputs == len(WAYS) and outcome.became == {"read": 1, "refused": 1}
    by_kind = {failure.where.split(" ")[0] for failure in outcome.failures}
    assert by_kind == {"AssertionError", "ZeroDivisionError", "crash", "hang"}
    assert len(runner.kinds_of_failure(outcome, tmp_path)) == 4
    for failure in outcome.failures:
        kept = tmp_path / f"trap_{seed}_{failure.index}"
        assert (kept / "trap.txt").read_bytes() == target.input(seed, failure.index).data
        assert f"--target trap --seed {seed} --first {failure.index}" in (kept / "failure.txt").read_text()


def _first_ways(target, seed):
    return {target.input(seed, index).data.decode() for index in range(len(WAYS))}


def _fuzz(*arguments):
    tests = Path(__file__).resolve().parent.parent
    command = [sys.executable, "-m", "fuzzing", *arguments]
    return subprocess.run(command, cwd=tests, capture_output=True, text=True, check=False, timeout=100)


def test_the_exit_status_says_whether_anything_failed(tmp_path):
    target = target_named(TRAP)
    for way, status in (("refused", 0), ("raises", 1)):
        seed = next(seed for seed in range(1000) if target.input(seed, 0).data.decode() == way)
        done = _fuzz("--target", TRAP, "--seed", str(seed), "--count", "1", "--out", str(tmp_path))
        assert done.returncode == status, done.stderr
        assert f"seed {seed}" in done.stdout and f"{status} failures" in done.stdout
    assert "ZeroDivisionError" in done.stdout


def test_the_command_line_lists_all_targets():
    assert _fuzz("--list").stdout.split() == list(NAMES)
