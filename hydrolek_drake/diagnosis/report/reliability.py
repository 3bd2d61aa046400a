"""How far the posterior probabilities of models can be trusted: how often such names have been right.

The probabilities of `evidence.judging` weigh models that were fitted against each other. That the right one was not
among them, or got stuck, is not in them, and with ten thousand samples they are nearly always 1 or 0. What is told of
an effect is therefore its posterior probability times the share of names of the same kind that were right in the
concealed challenge, where the truth is known (reliability diagram, Murphy and Winkler, Applied Statistics 26, 1977),
with Jeffreys' half a case on either side.
"""

from functools import cache
from typing import Any

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.yaml_files import package_yaml


@cache
def reliability_data() -> dict[str, Any]:
    """Content of `reliability.yaml`."""
    return package_yaml(__package__, "reliability.yaml")


def reliability(kind: str) -> float:
    """Share of names of a kind that were right: (right + 1/2) / (all + 1).

    Args:
        kind: a key of `reliability.yaml`.
    """
    counted = reliability_data()[kind]
    return (float(counted["right"]) + 0.5) / (float(counted["of"]) + 1.0)


def kind_of(diagnosis: Diagnosis, path: str) -> str:
    """Which kind of name an effect of the best model is.

    Args:
        diagnosis: with a conclusion.
        path: of the effect's size.
    """
    best = diagnosis.best.hypothesis
    without = [j.hypothesis.fit.over_noise for j in diagnosis.judged if path not in j.hypothesis.ids]
    hardly = min(without, default=float("inf")) < NOISE.at * best.fit.over_noise
    if hardly:
        return "hardly_needed"
    return "beside_unknown" if diagnosis.verdict == "unlisted_physics" else "needed"
