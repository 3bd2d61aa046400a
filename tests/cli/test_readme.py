"""What the README and the programs beside it promise is there."""

import os
import re
import stat
from pathlib import Path

import pytest

from hydrolek_drake.cli.app import COMMANDS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("program", ["scripts/demo", "scripts/test", ".ci/run"])
def test_program_can_be_run(program):
    path = ROOT / program
    assert path.read_text().startswith("#!/usr/bin/env bash\n")
    assert path.stat().st_mode & stat.S_IXUSR and os.access(path, os.X_OK)


def test_commands_of_the_readme_exist():
    named = set(re.findall(r"`hydrolek ([a-z]+)", README))
    assert named and named <= set(COMMANDS)


def test_programs_of_the_readme_exist():
    named = re.findall(r"^\$ (scripts/\w+)", README, flags=re.MULTILINE)
    assert named and all((ROOT / name).is_file() for name in named)


def test_links_and_pictures_of_the_readme_exist():
    targets = [target for target in re.findall(r"\]\(([^)]+)\)", README) if "://" not in target]
    assert targets
    for link in targets:
        target, _, place = link.partition("#")
        assert (ROOT / target).exists(), target
        if place:  # a heading, as it is turned into an anchor
            headings = re.findall(
                r"^#+ (.+)$", (ROOT / target).read_text(encoding="utf-8"), flags=re.MULTILINE
            )
            anchors = [re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings]
            assert place in anchors, link
        if target.endswith(".png"):
            assert (ROOT / target).stat().st_size < 300_000


def test_python_example_of_the_readme_runs(capsys, monkeypatch):
    (example,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    monkeypatch.chdir(ROOT)
    exec(compile(example, "README.md", "exec"), {})
    assert "joint.angle: model and recording differ" in capsys.readouterr().out


def test_versions_are_exact_and_of_registries_only():
    lines = [line for line in (ROOT / "constraints.txt").read_text().splitlines() if not line.startswith("#")]
    pattern = re.compile(r"[A-Za-z0-9_.-]+==[A-Za-z0-9_.!+-]+( ; python_(full_)?version >= \"3\.[\d.]+\")?")
    assert lines and all(pattern.fullmatch(line) for line in lines)
    assert "hydrolek" not in " ".join(lines)
