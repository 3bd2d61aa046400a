"""One plant, two executions: the Drake Diagram beside rollout and recording, and searches that run against it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.identification.choices import METHODS
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit import fit_rig
from hydrolek_drake.identification.fit.rig_objective import RigObjective
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_on_diagram import ProblemOnDiagram
from hydrolek_drake.recordings import read_recording, write_recording
from hydrolek_drake.replay.confirmation import confirm
from hydrolek_drake.rigs import load_rig

BENCH = Path(__file__).parents[1] / "data" / "bench"
SHORT = ("ga",)

WITHIN_DEG = 0.02
"""What the executions may be apart (docs/evidence/agreement.md)."""


@pytest.fixture(scope="module")
def rig():
    return load_rig("joint_bench")


@pytest.fixture(scope="module")
def recording(rig):
    """Five seconds of a machine without a concealed effect."""
    whole = read_recording(BENCH / "practice_01" / "train.csv", rig.columns)
    return whole.between(whole.time[0], whole.time[0] + 5.0)


@pytest.fixture(scope="module")
def searched(rig):
    names = [path for path in rig.free_parameters() if path.rpartition(".")[2] in ("pressure", "inertia")]
    return ParameterSet(rig, free_parameters(rig, names))


def test_the_diagram_follows_the_rollout_and_leaves_the_same_of_the_recording(rig, recording):
    told: list[str] = []
    [found] = confirm(rig, [recording], more=told.append)
    assert np.degrees(found.apart_largest) < WITHIN_DEG and found.apart_rms <= found.apart_largest
    assert found.diagram_rms == pytest.approx(found.rollout_rms, abs=np.radians(WITHIN_DEG))
    assert "Drake diagram" in found.sentence() and json.dumps(found.as_json())
    assert told[0].startswith("0.5 of 5.0 s simulated, about ") and len(told) == 9


@pytest.mark.long("7 s")
def test_a_play_is_given_the_steps_that_its_blows_need(rig, recording):
    playing = rig.with_values({"joints.joint.effects.linkage.backlash.gap_rad": 0.01})
    [found] = confirm(playing, [recording])
    assert np.degrees(found.apart_largest) < WITHIN_DEG


def test_a_diagram_that_breaks_down_is_told(rig, recording):
    wild = rig.with_values({"supply.pressure": 1e16})
    [found] = confirm(wild, [recording])
    assert found.diverged is not None and found.diverged in found.sentence()


@pytest.mark.thorough
def test_a_genetic_search_ranks_its_population_alike_on_both(rig, recording, searched):
    short = replace(recording.between(recording.time[0], recording.time[0] + 2.5))
    experiments = experiments_of(rig, short)
    units = np.random.default_rng(5).uniform(size=(8, len(searched)))
    scores = [
        [float(RigObjective(problem)(unit)[0]) for unit in units]
        for problem in (Problem(searched, experiments), ProblemOnDiagram(searched, experiments))
    ]
    np.testing.assert_array_equal(np.argsort(scores[0]), np.argsort(scores[1]))
    np.testing.assert_allclose(scores[0], scores[1], rtol=0.02)


@pytest.mark.parametrize(
    "method",
    [m if m in SHORT else pytest.param(m, marks=pytest.mark.long("3 s each")) for m in METHODS],
)
def test_every_method_runs_on_the_diagram(rig, recording, searched, method):
    short = recording.between(recording.time[0], recording.time[0] + 1.5)
    wrong = rig.with_values({"supply.pressure": 1.1 * rig.value("supply.pressure")})
    paths = ["supply.pressure", "joints.joint.load.inertia"]
    fitted = fit_rig(wrong, [short], method, paths=paths, budget=4, plant="diagram", segments=2)
    assert fitted.evaluations >= 4 and np.isfinite(fitted.over_noise)


def test_the_command_confirms_and_can_leave_it_out(rig, recording, tmp_path, capsys):
    path = tmp_path / "short.csv"
    write_recording(recording, path)
    common = [
        "fit",
        "joint_bench",
        str(path),
        "--parameter",
        "supply.pressure",
        "--out",
        str(tmp_path / "out"),
    ]
    assert run(common) == 0
    assert "Drake diagram, short, joint.angle: within" in capsys.readouterr().out
    [told] = json.loads((tmp_path / "out" / "fit.json").read_text())["diagram"]
    assert told["key"] == "joint.angle" and np.degrees(told["apart_largest"]) < WITHIN_DEG
    assert run([*common, "--no-confirm"]) == 0
    assert "Drake diagram" not in capsys.readouterr().out
    assert run([*common, "--plant", "steam"]) == 2
    assert "choose rollout, diagram" in capsys.readouterr().err
