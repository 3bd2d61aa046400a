"""Every constant that is a choice of the method, by theme, with the principle or measurement that it comes from.

What follows from another constant is a property. Shapes of laws, sizes of unknown inputs and commands of proposed
experiments are lists of their own (`laws.terms`, `laws.inputs`, `evidence.proposal`), and so is what words such as
"slow" mean in a report (`locating.place`).
"""

from hydrolek_drake.diagnosis.settings.evidence import DATA, EVIDENCE, EXPERIMENTS, GAINS, NOISE
from hydrolek_drake.diagnosis.settings.search import FITS, Rung, Settings
from hydrolek_drake.diagnosis.settings.unlisted import DROPOUTS, LOCATING

__all__ = [
    "DATA",
    "DROPOUTS",
    "EVIDENCE",
    "EXPERIMENTS",
    "FITS",
    "GAINS",
    "LOCATING",
    "NOISE",
    "Rung",
    "Settings",
]
