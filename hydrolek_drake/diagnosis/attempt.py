"""One search with its judgement, and when to search again: with parts of the held-out data, or with other weights."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from hydrolek_drake.diagnosis.balance import told, weighed, weights_by
from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.conclusion import EXPLAINED, Conclusion, conclude
from hydrolek_drake.diagnosis.effort import FAR, LOOK
from hydrolek_drake.diagnosis.evidence import even, judge
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import cost_of, gain_needed
from hydrolek_drake.diagnosis.hollows import deepest, strayed
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.overlooked import overlooked, wanting
from hydrolek_drake.diagnosis.search import LAW_COSTS, Other, search, search_on
from hydrolek_drake.diagnosis.splitting import mixed
from hydrolek_drake.diagnosis.weighing import NEARER, weighted_by
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
    return _attempted(bench, found, lambda: search(bench, candidates, found, say, other), held_out, say)


def _attempted(
    bench: Workbench,
    found: Search,
    searching: Callable[[], None],
    held_out: Sequence[Experiment],
    say: Callable[[str], None],
) -> Known:
    """See `attempt`; the search fills what is found."""
    interrupted = False
    try:
        searching()
    except KeyboardInterrupt:
        if not found.hypotheses:
            raise
        interrupted = True
        bench.resume()
    say("holding the models against data that none of them was fitted to")
    best = found.best
    weighted = tuple(weighted_by(bench, best, held_out))
    if not interrupted and found.law is None:
        even(bench, found, weighted)
    if found.best is not best:
        best = found.best
        weighted = tuple(weighted_by(bench, best, held_out))
    bench.training = tuple(weighted_by(bench, best, bench.training))
    judged = tuple(judge(bench, found, weighted))
    return Known(bench, found, weighted, judged, conclude(judged), interrupted)


def balanced(
    known: Known, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> tuple[Known, str] | None:
    """The search again with signals that count alike, and a remark.

    None where the best model is near the noise or follows them alike.

    Raises:
        KeyboardInterrupt: before the nominal model was fitted.
    """
    best, bench = known.found.best, known.bench
    if best.fit.over_noise < FAR:
        return None
    weights = weights_by(bench, best)
    if not weights:
        return None
    say("no model comes near the noise: searching again with signals that count alike")
    again = bench.with_training(weighed(bench.training, weights))
    return attempt(again, candidates, weighed(known.held_out, weights), say), told(weights)


def by_their_noise(
    known: Known, alike: Known, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> Known | None:
    """The first search gone on with, from what the one with signals that count alike found.

    A pressure that rings may have kept the first one from an effect that explains all signals to their noise. None
    where the model does not come near it.

    Args:
        known: by the noise of each signal.
        alike: with signals that count alike, see `balanced`.
        candidates: every effect that may be added.
        say: told what is being done.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    best, bench = alike.found.best, known.bench
    if not best.effects or alike.interrupted:
        return None
    own = bench.fit(best.effects, best.values, bench.fine, LOOK)
    if own.fit.over_noise > min(FAR, NEARER * known.found.best.fit.over_noise):
        return None
    say("this comes near the noise of every signal: going on from there")
    return _whole(
        _attempted(
            bench,
            known.found,
            lambda: search_on(bench, candidates, known.found, own, say),
            known.held_out,
            say,
        )
    )


def by_more_data(known: Known, candidates: Sequence[Candidate], say: Callable[[str], None]) -> Known | None:
    """The search again in parts of both data. None where the held-out data do not show more than the training data.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    if not _unexcited(known.conclusion):
        return None
    say("the held-out recording shows more than the training data: fitting parts of both")
    both, kept = mixed(known.bench.training, known.held_out)
    second = _whole(attempt(known.bench.with_training(both), candidates, kept, say))
    return replace(second, conclusion=conclude(second.judged, accounted=True))


def by_both(known: Known, candidates: Sequence[Candidate], say: Callable[[str], None]) -> Known | None:
    """The search again in parts of both data, from other fits of the models that explain the training data.

    None where the best model does not fail on the held-out data, see `hollows`, and where nothing is found that does
    better there.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    if not strayed(known.conclusion.best):
        return None
    say(
        "the model that explains the training data fails on the held-out data: looking for what explains both"
    )
    return _from_elsewhere(
        known, candidates, deepest(known.bench, known.judged, candidates, known.held_out), say
    )


def in_place_of_law(
    known: Known, law: FoundLaw, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> Known | None:
    """The same where a law was found, if effects explain both data better from other places than it does.

    Training data that hang by a hair's breadth may have led the right effect into the wrong hollow, which predicts
    nothing, and a small sine makes up for a little of everything. None where no effects explain the training data.

    Args:
        known: what was found before the law.
        law: beside the nominal model.
        candidates: every effect that may be missing.
        say: told what is being done.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    elsewhere = deepest(known.bench, known.judged, candidates, known.held_out, most_models=1)
    if not elsewhere:
        return None
    best = elsewhere[0]
    ahead = known.bench.residuals(best, known.held_out, known.bench.fine)
    counted = sum(experiment.counted for experiment in known.held_out)
    # the law's data are weighed by what the nominal model leaves, so that multiples of the noise are compared
    by_law = law.fit.over_noise**2 * best.fit.counted + law.held_out_over_noise**2 * counted
    if cost_of(best) + float(ahead @ ahead) >= by_law + LAW_COSTS * gain_needed(best.fit):
        return None
    say("known effects explain both recordings better than a law does: going on from there")
    return _from_elsewhere(known, candidates, elsewhere, say)


def _from_elsewhere(
    known: Known,
    candidates: Sequence[Candidate],
    elsewhere: Sequence[Hypothesis],
    say: Callable[[str], None],
) -> Known | None:
    """The search in parts of both data, from fits that leave little of both; None where it does no better."""
    both, kept = mixed(known.bench.training, known.held_out)
    again = known.bench.with_training(both)
    return _gone_on(known, again, [known.found.baseline, *elsewhere], kept, candidates, say)


def by_what_was_overlooked(
    known: Known, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> Known | None:
    """The search gone on with from an effect that promised nothing, see `overlooked`.

    None where the best model lacks nothing ahead, and where no effect does better there.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    best, bench = known.conclusion.best, known.bench
    if not wanting(best):
        return None
    say("the held-out data leave more than noise: fitting every effect, whether it promises anything or not")
    better = overlooked(bench, best.hypothesis, candidates, known.held_out)
    if not better:
        return None
    fits = [known.found.baseline, best.hypothesis, *better]
    return _gone_on(known, bench, fits, known.held_out, candidates, say)


def _gone_on(
    known: Known,
    bench: Workbench,
    fits: Sequence[Hypothesis],
    held_out: Sequence[Experiment],
    candidates: Sequence[Candidate],
    say: Callable[[str], None],
) -> Known | None:
    """A search from the best of some fits; None where what it ends with explains the held-out data no better."""
    found = Search(scores=known.found.scores)
    for fitted in bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), fits):
        found.keep(fitted)
    found.weighed_at = found.baseline.fit.over_noise
    second = _whole(
        _attempted(bench, found, lambda: search_on(bench, candidates, found, found.best, say), held_out, say)
    )
    if second.conclusion.verdict == "unlisted_physics":
        return None
    return second if second.conclusion.best.unaccounted < known.conclusion.best.unaccounted else None


def _whole(known: Known) -> Known:
    """The same, if it was not interrupted.

    Raises:
        KeyboardInterrupt: it was.
    """
    if known.interrupted:
        raise KeyboardInterrupt
    return known


def law_first(known: Known) -> bool:
    """Whether a law is tried before more data are fitted: effects that the training data ask for fail ahead.

    Where physics in no list is the reason, effects may imitate it in the training data, and fitting parts of both
    recordings costs a whole search and changes nothing. Where the nominal model explains the training data, only more
    of them tell what is missing.
    """
    unlisted = known.conclusion.verdict == "unlisted_physics"
    return unlisted and _unexcited(known.conclusion) and known.found.baseline.fit.over_noise > EXPLAINED


def predicting(law: FoundLaw) -> bool:
    """Whether a law explains the training data and predicts the held-out data as a right model does."""
    return law.fit.over_noise <= EXPLAINED and law.held_out_over_noise <= PREDICTED


def _unexcited(conclusion: Conclusion) -> bool:
    """Whether the held-out data show what the training data do not.

    A model explains the training data or, where no model reaches the noise, does far better on them.
    """
    best = conclusion.best
    if conclusion.verdict != "unlisted_physics":
        return best.over_noise > PREDICTED
    return best.hypothesis.fit.over_noise <= max(EXPLAINED, best.over_noise / FAR_AHEAD)
