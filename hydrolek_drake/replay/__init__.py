"""Driving a rig's model with a recorded command, and comparing what it does with what was measured."""

from hydrolek_drake.replay.comparison import Comparison, compare
from hydrolek_drake.replay.replay import Replay, replay

__all__ = ["Comparison", "Replay", "compare", "replay"]
