"""Which signals of a recording a joint's model can be held against, and both of them in the same unit."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics import sensor
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rollout import Signals

SUPPLY_KEY = "supply.pressure"


@dataclass(frozen=True)
class Pair:
    """One signal as measured and as the model has it.

    Attributes:
        key: `<joint>.<quantity>` or `supply.pressure`.
        unit: SI unit of both.
        joint: whose movement explains the signal; None if several joints share it.
        measured: NaN where the recording has no value. # (n,)
        model: NaN after a divergence. # (n,)
    """

    key: str
    unit: str
    joint: str | None
    measured: np.ndarray
    model: np.ndarray

    @property
    def residual(self) -> np.ndarray:
        """Measured minus model."""
        return self.measured - self.model


def driven_joints(rig: Rig, recording: Recording) -> list[str]:
    """Joints of the rig that have a command in a recording."""
    return [joint for joint in rig.joints if f"{joint}.command" in recording.signals]


def position_key(rig: Rig, joint: str) -> str:
    """Key of the joint's position: `<joint>.angle` if it turns, `<joint>.position` if it slides."""
    return f"{joint}.{'position' if rig.variant(joint, 'load') == 'sliding' else 'angle'}"


def measured_position(rig: Rig, joint: str, recording: Recording) -> np.ndarray:
    """The recorded position [rad or m]; a potentiometer's voltage is converted with (3.3).

    Raises:
        InputError: the recording has neither, or the rig does not say how volts become an angle.
    """
    key, pot = position_key(rig, joint), f"{joint}.pot"
    if key in recording.signals or pot not in recording.signals:
        require(recording, [key])
        return recording.signal(key)
    if rig.variant(joint, "sensor") != "potentiometer":
        raise InputError(
            f"{recording.source}: {pot} is there but not {key}, and rig {rig.name} has no potentiometer at "
            f"{joint}; record {key}, or give joints.{joint}.sensor the variant potentiometer with "
            "volts_per_degree and zero_voltage"
        )
    require(recording, [pot], units={pot: "V"})
    record: Any = rig.records()[rig.joints.index(joint)]
    volts: Any = recording.signal(pot)  # Any: the equation is compiled for whatever it is given
    return np.radians(sensor.angle_from_voltage(volts, record))


def pairs_of_joint(rig: Rig, joint: str, recording: Recording, signals: Signals) -> list[Pair]:
    """Position; chamber pressures where they were recorded, do not drive the model, and the joint has chambers.

    Of a drive that follows a position also the current, where that was recorded.
    """
    key = position_key(rig, joint)
    unit = "m" if key.endswith(".position") else "rad"
    pairs = [Pair(key, unit, joint, measured_position(rig, joint, recording), signals.reading)]
    if rig.is_hydraulic(joint):
        for quantity in ("pressure_a", "pressure_b"):
            key = f"{joint}.{quantity}"
            if key in recording.signals and key not in rig.driven_by:
                pairs.append(Pair(key, "Pa", joint, recording.signal(key), getattr(signals, quantity)))
    key = f"{joint}.current"
    if rig.tells_current(joint) and key in recording.signals:
        pairs.append(Pair(key, "A", joint, recording.signal(key), signals.current))
    return pairs


def supply_pair(rig: Rig, recording: Recording, by_joint: dict[str, Signals]) -> Pair | None:
    """The supply pressure, if it was recorded, does not drive the model, and a joint draws from it.

    The joints that do have one in common.
    """
    drawing = [joint for joint in by_joint if rig.is_hydraulic(joint)]
    if SUPPLY_KEY not in recording.signals or SUPPLY_KEY in rig.driven_by or not drawing:
        return None
    model = by_joint[drawing[0]].supply_pressure
    return Pair(
        SUPPLY_KEY, "Pa", drawing[0] if len(drawing) == 1 else None, recording.signal(SUPPLY_KEY), model
    )
