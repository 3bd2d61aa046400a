"""constraints.txt can be installed on every Python that pyproject.toml allows, first patch releases among them."""

import importlib.metadata
import re
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.10.0", "3.11.0", "3.11.2", "3.12.0", "3.13.0")


def pins() -> list[Requirement]:
    lines = (line.split("#")[0].strip() for line in (ROOT / "constraints.txt").read_text().splitlines())
    return [Requirement(line) for line in lines if line]


@pytest.mark.parametrize("python", PYTHONS)
def test_no_pinned_version_refuses_a_python_that_the_project_supports(python: str) -> None:
    supported = re.search(r'^requires-python = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert supported and python in SpecifierSet(supported[1])
    needs = {
        canonicalize_name(found.metadata["Name"]): (
            found.version,
            found.metadata.get("Requires-Python") or "",
        )
        for found in importlib.metadata.distributions()
    }
    where = {"python_version": ".".join(python.split(".")[:2]), "python_full_version": python}
    compared, refused = 0, []
    for pin in pins():
        version, needed = needs.get(canonicalize_name(pin.name), ("", ""))
        if version not in pin.specifier or (pin.marker is not None and not pin.marker.evaluate(where)):
            continue
        compared += 1
        if python not in SpecifierSet(needed):
            refused.append(f"{pin} needs Python {needed}")
    assert compared > 50
    assert not refused
