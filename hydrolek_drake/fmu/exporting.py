"""Writing a rig as a unit that runs in other programs."""

import contextlib
import hashlib
import importlib.util
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import being_written
from hydrolek_drake.fmu.model import resources
from hydrolek_drake.physics.driven import is_driven
from hydrolek_drake.rigs import Rig

BUILDERS = {2: ("pythonfmu", "Fmi2Slave"), 3: ("pythonfmu3", "Fmi3SlaveBase")}
"""Version of FMI -> package that builds such units, and its base class, which it looks for in the text of a script."""

EXTRA = "hydrolek-drake[fmu]"

_SCRIPT = """\
from {package} import {base}

from hydrolek_drake.fmu.fmi{version} import RigInstance


class {name}(RigInstance, {base}):
    pass
"""


def export(
    rig: Rig, joints: Sequence[str], path: Path, version: int, step_size: float, stop_time: float
) -> Path:
    """Write joints of a rig as a co-simulation unit.

    It holds the rig, not the code: the program that runs it finds this package in its Python.

    Args:
        rig: the machine.
        joints: that are commanded, in the rig's order; the others stand still where the rig has them.
        path: `.fmu` file.
        version: of FMI.
        step_size: that simulators take unless told otherwise [s].
        stop_time: when they end unless told otherwise [s].

    Raises:
        InputError: the package that builds it is missing, a recording drives the rig, or the file cannot be written.
    """
    package, base = BUILDERS[version]
    if importlib.util.find_spec(package) is None:
        raise InputError(
            f"export: FMI {version} is written by {package}, which is not installed: pip install '{EXTRA}'"
        )
    if path.suffix != ".fmu":
        raise InputError(f"export: {path} is no name of a unit; write {path.with_suffix('.fmu')}")
    if is_driven(rig.records()):
        raise InputError(
            f"export: rig {rig.name} is driven by recorded signals, which there are none of in a simulation; take "
            "'driven_by' out of its 'recording' section"
        )
    contents = resources(rig, list(joints), rig.title, step_size, stop_time)
    mark = hashlib.sha256(repr((version, sorted(contents.items()))).encode()).hexdigest()[:12]
    name = re.sub(r"\W", "_", path.stem, flags=re.ASCII)
    name = name if re.match(r"[A-Za-z]", name) else f"rig_{name}"
    with tempfile.TemporaryDirectory() as scratch, _left_as_it_was():
        folder = Path(scratch) / "script"
        folder.mkdir()
        # one process may run several units, whose scripts must not be taken for each other
        script = folder / f"{name}_{mark}.py"
        script.write_text(_SCRIPT.format(package=package, base=base, version=version, name=name))
        for file, content in contents.items():
            (folder / file).write_text(content)
        module: Any = import_module(f"hydrolek_drake.fmu.fmi{version}")
        built = import_module(package).FmuBuilder.build_FMU(
            script,
            dest=Path(scratch) / "built",
            project_files=[folder / file for file in contents],
            **module.OPTIONS,
        )
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with being_written(path) as part:
                shutil.copyfile(built, part)
        except OSError as error:
            raise InputError(f"export: cannot write {path}: {error.strerror or error}") from None
    return path


@contextlib.contextmanager
def _left_as_it_was() -> Iterator[None]:
    """A builder leaves its script among the modules, and its folder in their path."""
    places, known = list(sys.path), set(sys.modules)
    try:
        yield
    finally:
        sys.path[:] = places
        for name in set(sys.modules) - known:
            file = getattr(sys.modules[name], "__file__", None)
            if file and Path(file).parent.name == "script":
                del sys.modules[name]
