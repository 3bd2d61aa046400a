"""Recorded signals that drive joints in place of a part of their model, over the time of a diagram."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.physics.probes import PROBES, probe_at


class Recorded:
    """What was recorded of each joint, on straight lines between samples, from the diagram's time 0 on."""

    def __init__(self, joints: Sequence[tuple[float, np.ndarray] | None]):
        """Build.

        Args:
            joints: of each joint the spacing of its samples [s], and `probes.PROBES` with what was recorded at the
                places of `driven.INPUTS`, # (k, 15); None where nothing drives it.
        """
        self._series = [None if one is None else (one[0], np.ascontiguousarray(one[1])) for one in joints]
        self._none = np.zeros(len(PROBES))

    def at(self, time: float) -> np.ndarray:
        """Inputs of all joints at a time [s]. # (n, 15)."""
        return np.array(
            [self._none if one is None else probe_at(time, 0.0, one[0], one[1]) for one in self._series]
        )
