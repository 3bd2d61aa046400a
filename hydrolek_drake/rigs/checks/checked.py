"""What of a rig its checks look at."""

from pathlib import Path
from typing import Protocol

from hydrolek_drake.effects.effect import Effect


class Checked(Protocol):
    """What of a rig is looked at here, see `rig.Rig`; a rig checks itself, so that it stands above this."""

    @property
    def path(self) -> Path:
        """The file it came from."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the moving joints."""

    @property
    def variants(self) -> dict[str, str]:
        """The chosen variant of each stage."""

    def value(self, path: str) -> float:
        """Value of a parameter in SI."""

    def owner(self, effect: Effect, joint: str) -> str:
        """The joint whose parameters of an effect act on `joint`."""
