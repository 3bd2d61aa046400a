"""A rig that is exported runs in FMPy's simulator, passes its checks, and does what the rollout does."""

import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.fmu.exporting import export
from hydrolek_drake.fmu.foreign import play, read_unit
from hydrolek_drake.fmu.model import Model, resources
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.rollout.together.together import JointsTogether

pytest.importorskip("fmpy", reason="needs the extra fmu")
pytest.importorskip("pythonfmu", reason="needs the extra fmu")
pytest.importorskip("pythonfmu3", reason="needs the extra fmu")

from fmpy.validation import validate_fmu

pytestmark = pytest.mark.long("two minutes: each unit is a process that loads all anew")

SAMPLE = 0.01
ROUNDING = 1e-9
"""Share of a signal's range."""

TOLD = {
    "joint.angle": "reading",
    "joint.true_angle": "position",
    "joint.rate": "velocity",
    "joint.pressure_a": "pressure_a",
    "joint.pressure_b": "pressure_b",
    "joint.spool": "spool",
    "supply.pressure": "supply_pressure",
}


def _rolled(rig: Rig, volts: np.ndarray, times: np.ndarray, step: float | None = None) -> Signals:
    given = SAMPLE * np.arange(volts.size)
    own = rig.value("integration.longest_step")
    spool = int(rig.value("integration.spool_steps"))
    done = roll_out(rig.records(), given, volts, times, longest_step=step or own, spool_steps=spool)
    assert done.diverged is None
    return done.signals


def _simulated(
    unit: Path, volts: np.ndarray, every: float = SAMPLE, start: dict[str, float] | None = None
) -> dict[str, np.ndarray]:
    """Run by FMPy, in a process of its own: a unit that fails leaves Python in a bad state."""
    described = read_unit(unit)
    return play(described, {"joint.command": volts}, list(TOLD), every, start=start)


@pytest.mark.parametrize("version", [2, 3])
def test_its_signals_are_those_of_the_rollout(
    version: int, exported: Callable[[int], Path], enlarged: Rig, volts: np.ndarray
) -> None:
    unit = exported(version)
    assert validate_fmu(str(unit)) == []
    done = _simulated(unit, volts)
    wanted = _rolled(enlarged, volts, SAMPLE * np.arange(volts.size))
    assert np.ptp(wanted.reading) > 0.1
    for name, signal in TOLD.items():
        own = getattr(wanted, signal)
        assert np.abs(done[name] - own).max() <= ROUNDING * max(np.ptp(own), np.abs(own).max()), name


def test_another_start_is_kept_and_another_communication_step_costs_no_more_than_the_integration(
    exported: Callable[[int], Path], enlarged: Rig
) -> None:
    every, held = 0.00173, np.full(900, 3.0)
    done = _simulated(exported(2), held, every, {"joint.initial_angle": 0.6})
    rig = enlarged.with_values({"load.initial_position": 0.6})
    step, times = rig.value("integration.longest_step"), every * np.arange(held.size)
    wanted = _rolled(rig, held[:1], times).reading  # whose steps end where it is told, too
    assert np.ptp(wanted) > 0.1
    assert np.abs(done["joint.angle"] - wanted).max() <= ROUNDING * np.ptp(wanted)
    own, converged = (_rolled(rig, held[:1], times[::10], each).reading for each in (step, step / 32))
    assert np.abs(done["joint.angle"][::10] - converged).max() <= 2.0 * np.abs(own - converged).max()


def test_joints_that_share_an_arm_are_one_unit(two_joints: Rig, tmp_path: Path) -> None:
    unit = export(two_joints, two_joints.joints, tmp_path / "arm.fmu", 2, SAMPLE, 1.0)
    assert validate_fmu(str(unit)) == []
    volts = np.repeat(np.random.default_rng(5).uniform(-3.0, 3.0, (4, 2)), 10, axis=0)
    names = [f"{joint}.angle" for joint in two_joints.joints]
    commands = {f"{joint}.command": volts[:, i] for i, joint in enumerate(two_joints.joints)}
    done = play(read_unit(unit), commands, names, SAMPLE)
    records, times = two_joints.records(), SAMPLE * np.arange(len(volts))
    together = JointsTogether(two_joints, two_joints.joints)
    rolled = together.roll_out(records, times, volts, times, records["load"]["initial_position"])
    for i, name in enumerate(names):
        wanted = rolled.signals["reading"][:, i]
        assert np.abs(done[name] - wanted).max() <= ROUNDING * np.ptp(wanted)


def test_joints_of_an_arm_that_nobody_commands_give_way(tmp_path: Path) -> None:
    rig = load_rig("hydrolek", {})
    for name, content in resources(rig, ["right_j2", "right_j3"], "", SAMPLE, 1.0).items():
        (tmp_path / name).write_text(content)
    model = Model(tmp_path)
    model.begin(0.0)
    assert {each.joint for each in model.variables.values()} == {"right_j2", "right_j3"}
    begun = model.value("right_j3.angle")
    model.put("right_j3.command", 4.0)
    for k in range(30):
        model.step(SAMPLE * k, SAMPLE)
    assert 1e-3 < abs(model.value("right_j3.angle") - begun) < 1.0


def test_the_unit_holds_the_rig_with_what_was_set(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    unit = tmp_path / "soft.fmu"
    assert run(["export", "joint_bench", "-o", str(unit), "--set", "supply.pressure=9 MPa"]) == 0
    assert "joint.command [V]" in capsys.readouterr().out
    with zipfile.ZipFile(unit) as archive:
        archive.extract("resources/rig.yaml", tmp_path)
    assert load_rig(str(tmp_path / "resources" / "rig.yaml"), {}).value("supply.pressure") == 9e6


def test_a_model_that_leaves_all_bounds_says_so(tmp_path: Path) -> None:
    rig = load_rig("joint_bench").with_values({"integration.longest_step": 0.05})
    unit = export(rig, rig.joints, tmp_path / "coarse.fmu", 3, 0.1, 4.0)
    with pytest.raises(InputError, match=r"joint: left all bounds at"):
        _simulated(unit, np.array([8.0, -8.0] * 20), every=0.1)


def test_what_cannot_be_exported_is_refused(tmp_path: Path) -> None:
    rig = load_rig("joint_bench")
    with pytest.raises(InputError, match=r"write .*model\.fmu"):
        export(rig, rig.joints, tmp_path / "model.zip", 2, SAMPLE, 1.0)
    with pytest.raises(InputError, match="driven by recorded signals"):
        export(replace(rig, driven_by=("joint.spool",)), rig.joints, tmp_path / "m.fmu", 2, SAMPLE, 1.0)
    assert run(["export", "joint_bench", "-o", str(tmp_path / "m.fmu"), "--joint", "elbow"]) == 2
    assert run(["export", "joint_bench", "-o", str(tmp_path / "m.fmu"), "--fmi", "1"]) == 2
    assert list(tmp_path.iterdir()) == []
