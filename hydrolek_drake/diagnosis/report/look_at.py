"""One line that says what to look at on the machine."""

from functools import cache

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.yaml_files import package_yaml


@cache
def stage_sentences() -> dict[str, str]:
    """Content of `look_at.yaml`: stage -> what to look at where a law for physics in no list acts."""
    return package_yaml(__package__, "look_at.yaml")


def look_at(diagnosis: Diagnosis) -> str:
    """What to look at first; empty where nothing is missing or nothing is known.

    Of several effects the one that is held most probable leads, which is the one without which most is left.
    """
    if diagnosis.verdict in ("bad_data", "none") or diagnosis.conclusion is None:
        return ""
    if diagnosis.law is not None:
        stage, joint = diagnosis.law.law.input.stage, diagnosis.law.joint
        return f"{joint}, {stage}: {stage_sentences()[stage]}"
    listed = diagnosis.best.hypothesis.listed
    if not listed:
        return ""
    probability = diagnosis.conclusion.probability
    first = max(listed, key=lambda c: (probability.get(c.size_path, 0.0), _left(diagnosis, c.size_path)))
    return f"{first.joint}, {first.effect.stage}: {first.effect.inspect}"


def _left(diagnosis: Diagnosis, path: str) -> float:
    """The least that is left over the noise without an effect."""
    without = [j.over_noise for j in diagnosis.judged if path not in j.hypothesis.ids]
    return min(without, default=0.0)
