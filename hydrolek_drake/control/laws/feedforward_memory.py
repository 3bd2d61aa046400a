"""What the feedforward law remembers from sample to sample, as a flat state and by name."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from hydrolek_drake.control.laws.law import Array


@dataclass
class Memory:
    """State of one joint's feedforward law.

    Attributes:
        running: 1 after the first sample.
        standing: samples since the valve closed because the joint has arrived; 0 while it is to move.
        angle: estimate [deg].
        set_point: of the last sample [deg].
        slope: of the set point [deg/s].
        share_down, share_up: saturation rates over those of the map, per direction.
        edge_down, edge_up: how much further out the dead-zone's edges are than in the map [V].
        late_down, late_up: dead time beyond the map's [s].
        rest_deg: where a braked joint was expected to stop.
        landing: the rate from which it was braked [deg/s]; 0 when that has been judged.
        known_down, known_up: 1 where a jog has told the dead-zone's edge.
        jog: samples since the present jog began, counted from 1; 0 for no jog.
        jog_deg: angle before it.
        jog_sum: ways since then, summed over time [deg s].
        jog_tail: ways of the samples by which it must have ended, summed [deg].
        jog_V: size of its voltage.
        jog_edge_V: shift of the dead-zone's edge that was known before it.
        jog_again: 1 if a jog before it did not move the joint.
        push: what is added to the wanted rate because the joint stands though it should move [deg/s].
        voltages: the last ones, newest first [V].
        estimates: the last ones of the angle, newest first [deg].
    """

    running: float
    standing: float
    angle: float
    set_point: float
    slope: float
    share_down: float
    share_up: float
    edge_down: float
    edge_up: float
    late_down: float
    late_up: float
    rest_deg: float
    landing: float
    known_down: float
    known_up: float
    jog: float
    jog_deg: float
    jog_sum: float
    jog_tail: float
    jog_V: float
    jog_edge_V: float
    jog_again: float
    push: float
    voltages: list[float]
    estimates: list[float]

    @classmethod
    def unpack(cls, state: Array, voltages: int) -> "Memory":
        """From a flat state with that many past voltages."""
        values = state.tolist()
        rest = values[SCALARS:]
        arguments: list[Any] = [*values[:SCALARS], rest[:voltages], rest[voltages:]]
        return cls(*arguments)

    @classmethod
    def at_rest(cls, angle: float, voltages: int, estimates: int) -> "Memory":
        """Nothing on its way, nothing learned."""
        memory = cls.unpack(np.zeros(SCALARS + voltages + estimates), voltages)
        memory.angle = memory.set_point = angle
        memory.share_down = memory.share_up = 1.0
        memory.estimates = [angle] * estimates
        return memory

    def pack(self) -> Array:
        """As a flat state."""
        return np.array([*(getattr(self, name) for name in _NAMES), *self.voltages, *self.estimates])

    @property
    def mean(self) -> float:
        """The angle's estimate, averaged over the window [deg]."""
        return (self.angle + sum(self.estimates)) / (1 + len(self.estimates))

    def share(self, sign: float) -> float:
        """Saturation rate over that of the map, in a direction."""
        return self.share_up if sign > 0.0 else self.share_down

    def edge(self, sign: float) -> float:
        """Shift of the dead-zone's edge in a direction [V]."""
        return self.edge_up if sign > 0.0 else self.edge_down

    def late(self, sign: float) -> float:
        """Dead time beyond the map's in a direction [s]."""
        return self.late_up if sign > 0.0 else self.late_down

    def known(self, sign: float) -> bool:
        """Whether a jog has told the dead-zone's edge in a direction."""
        return bool(self.known_up if sign > 0.0 else self.known_down)

    def learn_known(self, sign: float) -> None:
        """Keep that it has."""
        setattr(self, "known_up" if sign > 0.0 else "known_down", 1.0)

    def learn_share(self, sign: float, value: float) -> None:
        """Keep a share."""
        setattr(self, "share_up" if sign > 0.0 else "share_down", value)

    def learn_edge(self, sign: float, value: float) -> None:
        """Keep an edge."""
        setattr(self, "edge_up" if sign > 0.0 else "edge_down", value)

    def learn_late(self, sign: float, value: float) -> None:
        """Keep a dead time."""
        setattr(self, "late_up" if sign > 0.0 else "late_down", value)


_NAMES = tuple(field.name for field in fields(Memory))[:-2]
SCALARS = len(_NAMES)
"""Numbers of a state before the past voltages and estimates."""
