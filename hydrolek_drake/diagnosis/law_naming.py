"""Which of several fitted laws are believed, and which one of those that predict alike is named."""

from collections.abc import Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.attempt import PREDICTED
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import NOISE_KNOWN
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED, gain_needed
from hydrolek_drake.diagnosis.judged import flatter
from hydrolek_drake.diagnosis.law_fit import STEPS
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench

BETTER = 0.8
"""A law must take the held-out error below this share of what it was, or it is no law of this machine. So must it that
of the training data, unless it explains them: what helps the held-out data alone may do so by chance."""


def ahead_to_beat(over_noise: float) -> float:
    """What a law must leave less of held-out data than, over the noise.

    Where a model predicts these as well as a right one would, no share of that is there to be taken: less will do, and
    the training data decide.

    Args:
        over_noise: that the model without the law leaves of them.
    """
    return max(BETTER * over_noise, min(over_noise, PREDICTED))


def helping(bench: Workbench, left: Hypothesis, laws: Sequence[FoundLaw], step: float) -> list[FoundLaw]:
    """Laws for which the training data speak.

    They take a material part of what the model leaves of these, or explain them. Where the model does so itself, they
    must gain what chance does not, or they only tip what hangs by a hair's breadth in the held-out recording.

    Args:
        bench: training data and fits.
        left: the model that leaves what the laws are to explain.
        laws: fitted beside it.
        step: of their fits [s].
    """
    most = max(EXPLAINED, BETTER * left.fit.over_noise)
    material = [law for law in laws if law.fit.over_noise < most]
    if not material or left.fit.over_noise > EXPLAINED:
        return material
    without = bench.refit(left, step, STEPS, tolerance=1e-4).fit
    return [law for law in material if without.objective - law.fit.objective > gain_needed(without)]


def likeliest(alike: Sequence[FoundLaw], in_all: Sequence[float], counted: int) -> FoundLaw:
    """The law that leaves least of all data, with the other stages at which one leaves hardly more.

    Where even the best leaves something systematic, such as the form of a friction that is not quite its own, what is
    hardly more is larger by that excess, see `judged.flatter`.
    A friction at the rod and one at the joint make the same movement and pressures if each may vary over the stroke
    as it likes, and so do any two forces there where the lever is constant, as of a vane. A short law is not quite the
    form of either, and how much of what it leaves that is nobody knows better than the noise: frictions on both sides
    are told apart only if they differ by more than that. Of two that do as well, a
    friction is named at the rod first, where seals are pressed on by the oil, and what pushes or shakes at the load;
    this is an assumption about such machines, and the other stage is told with it.

    Args:
        alike: laws that predict alike.
        in_all: what each leaves, see `left_in_all`.
        counted: how many values these are.
    """
    ranked = sorted(zip(in_all, range(len(alike)), strict=True))
    least, place = ranked[0]
    hardly = GAIN_NEEDED * flatter(least, counted, len(alike[place].fit.unit))
    best = alike[place]
    unsure = max(hardly, 2.0 * NOISE_KNOWN * least)
    near = [best] + [
        alike[i]
        for each, i in ranked[1:]
        if each < least + (unsure if _rubs(best.law) and _rubs(alike[i].law) else hardly)
    ]
    if best.law.input.stage in ("cylinder", "load"):
        wanted = "cylinder" if best.law.brakes else "load"
        same = (f for f in near if f.law.input.stage == wanted and f.law.brakes == best.law.brakes)
        best = next(same, best)
    stages = {f.law.input.stage for f in near} - {best.law.input.stage}
    return replace(best, rivals=tuple(sorted(stages)))


def _rubs(law: Law) -> bool:
    """Whether it is a friction at the rod or at the load."""
    return law.brakes and law.input.stage in ("cylinder", "load")
