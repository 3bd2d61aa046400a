"""What stands behind the link: a simulated machine, or a user's own hardware by an adapter of his."""

import importlib
import importlib.util
import sys
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.link.authority import LinkOrder
from hydrolek_drake.teleop.link.signals import Signals

Array = NDArray[np.float64]

_JOINTS = 14


@runtime_checkable
class Arms(Protocol):
    """A machine with controllers, as the link drives it. All calls come from one thread.

    Attributes:
        period: Seconds between two samples.
    """

    period: float

    def advance(self, order: LinkOrder) -> None:
        """Carry out what the client wants for one sample; with `valves_open` false, close all valves."""
        ...

    def measured(self) -> Array:
        """Joints `right_j1` ... `left_j7` in rad, shape (14,)."""
        ...

    def signals(self) -> Signals | None:
        """Voltages, pressures and the like, or None."""
        ...

    def close(self) -> None:
        """Close all valves and let the hardware go; called once, whatever has happened."""
        ...


def load_adapter(text: str) -> Arms:
    """Make a user's machine.

    Args:
        text: `MODULE:NAME` or `FILE.py:NAME`; NAME is called without arguments and gives an object like `Arms`.

    Raises:
        InputError: It cannot be found, or what it gives is not like `Arms`.
    """
    source, colon, name = text.rpartition(":")
    if not (colon and source and name.isidentifier()):
        raise InputError(
            f"adapter '{text}' is not MODULE:NAME or FILE.py:NAME, such as my_machine.py:Machine"
        )
    module = _from_file(Path(source)) if source.endswith(".py") else _from_module(source)
    make = getattr(module, name, None)
    if not callable(make):
        raise InputError(f"adapter {source}: there is nothing to call by the name '{name}'")
    try:
        arms: Arms = make()
    except Exception as error:
        raise InputError(f"adapter {text}: {type(error).__name__}: {error}") from None
    missing = [
        each for each in ("period", "advance", "measured", "signals", "close") if not hasattr(arms, each)
    ]
    if missing:
        raise InputError(
            f"adapter {text}: it has no '{missing[0]}'; docs/reference/link.md shows what is needed"
        )
    if not (isinstance(arms.period, (int, float)) and 0.0 < arms.period < np.inf):
        raise InputError(f"adapter {text}: period = {arms.period!r} must be seconds above 0")
    checked(arms.measured(), text)
    return arms


def checked(measured: Any, whose: str) -> Array:
    """Measured joints of an adapter, in rad, shape (14,).

    Raises:
        InputError: Not 14 finite numbers.
    """
    try:
        values = np.asarray(measured, dtype=float)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.shape != (_JOINTS,) or not np.isfinite(values).all():
        raise InputError(
            f"adapter {whose}: measured() gave {measured!r:.80}, not {_JOINTS} finite angles in rad"
        )
    return values


def _from_file(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise InputError(f"adapter {path}: there is no such file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look there
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise InputError(f"adapter {path}: {type(error).__name__}: {error}") from None
    return module


def _from_module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except Exception as error:
        raise InputError(f"adapter {name}: {type(error).__name__}: {error}") from None
