"""One search with its judgement."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.conclusion import EXPLAINED, Conclusion, conclude
from hydrolek_drake.diagnosis.evidence import even, judge, judge_as_fitted
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.search import Other, search
from hydrolek_drake.diagnosis.weighing import weighted_by
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

FAR_AHEAD = 2.0
"""A model that leaves this many times more on held-out data than on training data was not told by these what matters
there: three quarters of the squared error are of a kind that they do not show."""

PREDICTED = 1.2
"""A model that is right predicts held-out data to so many times the noise. Where it does worse, its parameters'
uncertainty or something else may be the reason, which only more data tell."""


@dataclass(frozen=True)
class Known:
    """What one search and its judgement gave.

    Attributes:
        bench: data and fits.
        found: all that was tried.
        held_out: data that nothing was fitted to, weighted by the best model.
        judged: hypotheses held against them, the most probable first.
        conclusion: what both say.
        interrupted: whether the search was ended by the user.
    """

    bench: Workbench
    found: Search
    held_out: tuple[Experiment, ...]
    judged: tuple[Judged, ...]
    conclusion: Conclusion
    interrupted: bool


def attempt(
    bench: Workbench,
    candidates: Sequence[Candidate],
    held_out: Sequence[Experiment],
    say: Callable[[str], None],
    other: Other | None = None,
) -> Known:
    """Search in the training data, and judge by the held-out data.

    Args:
        bench: data and fits.
        candidates: every effect that may be missing.
        held_out: data that nothing is fitted to.
        say: told what is being done.
        other: asked before a second and a third effect are added, what else explains the data.

    Raises:
        KeyboardInterrupt: before the nominal model was fitted; later ones end the search.
    """
    found = Search()
    return attempted(bench, found, lambda: search(bench, candidates, found, say, other), held_out, say)


def attempted(
    bench: Workbench,
    found: Search,
    searching: Callable[[], None],
    held_out: Sequence[Experiment],
    say: Callable[[str], None],
) -> Known:
    """See `attempt`; the search fills what is found. An interrupt of the judgement leaves a hasty one."""
    interrupted = False
    try:
        searching()
    except KeyboardInterrupt:
        if not found.hypotheses:
            raise
        interrupted = True
        bench.resume()
    say("holding the models against data that none of them was fitted to")
    try:
        weighted, judged = _judged(bench, found, held_out, evenly=not interrupted and found.law is None)
    except KeyboardInterrupt:
        interrupted = True
        bench.resume()
        weighted = tuple(held_out)
        judged = tuple(judge_as_fitted(bench, list(found.hypotheses.values()), weighted))
    return Known(bench, found, weighted, judged, conclude(judged), interrupted)


def whole(known: Known) -> Known:
    """The same, if it was not interrupted.

    Raises:
        KeyboardInterrupt: it was.
    """
    if known.interrupted:
        raise KeyboardInterrupt
    return known


def _judged(
    bench: Workbench, found: Search, held_out: Sequence[Experiment], *, evenly: bool
) -> tuple[tuple[Experiment, ...], tuple[Judged, ...]]:
    """Held-out data weighted by the best model, and what they say; training data are weighted by it too."""
    best = found.best
    weighted = tuple(weighted_by(bench, best, held_out))
    if evenly:
        even(bench, found, weighted)
    if found.best is not best:
        best = found.best
        weighted = tuple(weighted_by(bench, best, held_out))
    bench.training = tuple(weighted_by(bench, best, bench.training))
    return weighted, tuple(judge(bench, found, weighted))


def law_first(known: Known) -> bool:
    """Whether a law is tried before more data are fitted: effects that the training data ask for fail ahead.

    Where physics in no list is the reason, effects may imitate it in the training data, and fitting parts of both
    recordings costs a whole search and changes nothing. Where the nominal model explains the training data, only more
    of them tell what is missing.
    """
    unlisted = known.conclusion.verdict == "unlisted_physics"
    return unlisted and unexcited(known.conclusion) and known.found.baseline.fit.over_noise > EXPLAINED


def predicting(law: FoundLaw, slack: float = 1.0) -> bool:
    """Whether a law explains the training data and predicts the held-out data as a right model does.

    Args:
        law: fitted.
        slack: so many times what a right model may leave.
    """
    return law.fit.over_noise <= slack * EXPLAINED and law.held_out_over_noise <= slack * PREDICTED


def asked_for(law: FoundLaw, model: Hypothesis) -> bool:
    """Whether the training data ask for a law beside known effects: it takes of them what one more effect must.

    Where a joint sticks and slips, a law that takes nothing of the training data may by chance lead the held-out
    rollout into the right hollow, which other values of the model's own parameters do as well.

    Args:
        law: fitted beside the model.
        model: what it adds to; the nominal model is what it stands in place of.
    """
    left = law.fit.over_noise**2 * model.fit.counted
    return not model.effects or left + gain_needed(model.fit) < model.fit.objective


def unexcited(conclusion: Conclusion) -> bool:
    """Whether the held-out data show what the training data do not.

    A model explains the training data or, where no model reaches the noise, does far better on them.
    """
    best = conclusion.best
    if conclusion.verdict != "unlisted_physics":
        return best.over_noise > PREDICTED
    return best.hypothesis.fit.over_noise <= max(EXPLAINED, best.over_noise / FAR_AHEAD)
