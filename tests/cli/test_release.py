"""What is given away: one version everywhere, and recordings for `hydrolek demo`."""

import re
from pathlib import Path

import pytest
import yaml

import hydrolek_drake
from hydrolek_drake.cli.app import run
from hydrolek_drake.cli.diagnosis import diagnose
from hydrolek_drake.cli.diagnosis.demo import practice_pair

ROOT = Path(__file__).parents[2]
PROJECT = (ROOT / "pyproject.toml").read_text()  # its plain lines: Python 3.10 has no tomllib


def test_the_version_is_one_everywhere():
    project = dict(re.findall(r'^(version|license) = "(.+)"$', PROJECT, flags=re.MULTILINE))
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    newest = re.search(r"^## \[(\S+)\] - (\S+)$", (ROOT / "CHANGELOG.md").read_text(), flags=re.MULTILINE)
    assert project["version"] == cited["version"] == newest[1] == hydrolek_drake.__version__
    assert str(cited["date-released"]) == newest[2] and cited["license"] == project["license"]


def test_the_demo_diagnoses_the_recordings_that_come_along(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(diagnose, "diagnose", lambda *given, **named: asked.append((given, named)))
    assert run(["demo", "--out", str(tmp_path)]) == 0
    [((rig, (train,), (holdout,)), named)] = asked
    assert rig == "joint_bench" and train.is_file() and holdout.is_file() and named["out"] == tmp_path


def test_the_wheel_holds_them_where_an_installed_package_looks():
    assert (
        f'"{practice_pair().relative_to(ROOT).as_posix()}" = "hydrolek_drake/practice/practice_04"' in PROJECT
    )


@pytest.mark.parametrize("program", ["scripts/release_check", "scripts/test_pythons"])
def test_program_can_be_run(program):
    assert (ROOT / program).stat().st_mode & 0o111
