"""Joints moved by hand: joystick or sliders, with a dead-man's switch (thesis appendix A)."""

import time

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.workcell.trajectory import joint_speeds

Array = NDArray[np.float64]

JOYSTICK, SLIDERS = "joystick", "sliders"
_JOINTS = 14
_FULL = 100.0  # percent
_ROUNDING = np.radians(1e-3)  # of angles as text


class Hand:
    """What the operator's hand wants now. Not for several threads at once; its owner has the lock.

    A wish counts for `manual.hold` seconds of teleop.yaml. After a block nothing counts before `let_go`.

    Attributes:
        deflection: Of the joysticks in percent, shape (14,).
        set_point: Where the sliders' set point stands in rad, shape (14,); None while none is on its way.
    """

    def __init__(self) -> None:
        self._hold = teleop_entries("manual")["hold"]
        self._speed = joint_speeds()[0]
        self._lower, self._upper = travel()
        self._kind, self._last, self._blocked = "", -np.inf, False
        self.deflection: Array = np.zeros(_JOINTS)
        self.set_point: Array | None = None
        self._towards: Array = np.zeros(_JOINTS)

    def check(self, deflection: Array | None, towards: Array | None) -> Array | None:
        """Numbers of a wish, as of `move`, within their ranges; None if there are none.

        Raises:
            InputError: Not 14 numbers, or one outside its range.
        """
        if deflection is not None:
            return _checked(deflection, "deflections", np.full(_JOINTS, -_FULL), np.full(_JOINTS, _FULL), 1.0)
        if towards is not None:
            return _checked(towards, "angles", self._lower, self._upper, float(np.radians(1.0)))
        return None

    def move(self, measured: Array, deflection: Array | None, towards: Array | None) -> None:
        """Take a wish of the hand; repeats keep the motion alive.

        Args:
            measured: Joints in rad, shape (14,); the sliders' set point begins there.
            deflection: In percent, shape (14,).
            towards: Angles in rad, shape (14,), instead.

        Raises:
            InputError: Not 14 numbers, or one outside its range.
        """
        values = self.check(deflection, towards)
        if self._blocked:
            return
        if values is not None and deflection is not None:
            self.deflection, self.set_point, self._kind = values, None, JOYSTICK
        elif values is not None:
            self._towards = values
            if self.moving() != SLIDERS or self.set_point is None:
                self.set_point = np.clip(measured, self._lower, self._upper)
            self._kind = SLIDERS
        self._last = time.monotonic()

    def moving(self) -> str:
        """`joystick`, `sliders`, or empty when the hand has let go."""
        if time.monotonic() - self._last > self._hold:
            self._kind, self.set_point = "", None
        return self._kind

    def step(self, period: float) -> Array:
        """The sliders' set point after another period in s, in rad, shape (14,)."""
        assert self.set_point is not None  # `moving` says sliders
        most = self._speed * period
        self.set_point = self.set_point + np.clip(self._towards - self.set_point, -most, most)
        return self.set_point

    def let_go(self) -> None:
        """Nothing is held any more."""
        self._kind, self._last, self._blocked, self.set_point = "", -np.inf, False, None

    def block(self) -> None:
        """Let go, and heed nothing before the hand itself has let go."""
        self.let_go()
        self._blocked = True


def travel() -> tuple[Array, Array]:
    """Lower and upper ends of all joints in rad, each of shape (14,)."""
    limits = [joint_limits(side) for side in SIDES]
    lower, upper = (np.concatenate([each[i] for each in limits]) for i in (0, 1))
    return lower, upper


def within_limits(posture: Array) -> Array:
    """A measured posture without what noise puts beyond a stop, in rad, shape (14,)."""
    return np.clip(posture, *travel())


def _checked(values: Array, what: str, lower: Array, upper: Array, unit: float) -> Array:
    given = np.asarray(values, dtype=float)
    if given.shape != (_JOINTS,):
        raise InputError(f"{len(given) if given.ndim else 1} {what} were sent; {_JOINTS} are needed")
    for joint, value in enumerate(given):
        if not lower[joint] - _ROUNDING <= value <= upper[joint] + _ROUNDING:
            name = f"{SIDES[joint // 7]}_j{joint % 7 + 1}"
            raise InputError(
                f"{name} = {value / unit:g} is outside {lower[joint] / unit:.1f} to {upper[joint] / unit:.1f}"
            )
    return np.clip(given, lower, upper)
