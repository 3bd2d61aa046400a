"""The compiled execution: one joint's whole chain in one loop, fast enough to be fitted."""

from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import Outcome, Signals, roll_out

__all__ = ["Outcome", "Signals", "rest_state", "roll_out"]
