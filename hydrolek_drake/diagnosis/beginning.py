"""How much of a recording first fits must see.

What is missing may show only late, as a cushion does at an end of the stroke that the joint reaches after half a
minute. Fits to a part in which nothing is missing tell nothing.
"""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.effort import GLANCE_S
from hydrolek_drake.identification.experiment import Experiment

SHOWN = 0.2
"""Share of the squared residuals that first fits must see. An error spread evenly over 40 s shows it after 8 s, one
that grows with time after 23 s."""


def shown_by(residuals: np.ndarray, experiments: Sequence[Experiment]) -> float:
    """Seconds after the first sample in which a model shows `SHOWN` of what it leaves, at least `GLANCE_S`.

    Args:
        residuals: of all experiments, channel after channel. # (values,)
        experiments: to which they belong.
    """
    times = np.concatenate([e.time - e.time[0] for e in experiments for _ in e.channels])
    in_order = np.argsort(times, kind="stable")
    shown = np.cumsum(residuals[in_order] ** 2)
    late = times[in_order][np.searchsorted(shown, SHOWN * shown[-1])]
    return max(GLANCE_S, float(late))
