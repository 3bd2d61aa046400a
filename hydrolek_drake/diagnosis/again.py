"""When to search again, and in what: parts of the held-out data, other weights, or from other places."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.attempt import PREDICTED, Known, attempt, attempted, unexcited, whole
from hydrolek_drake.diagnosis.balance import told, weighed, weights_by
from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.conclusion import EXPLAINED, conclude
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, FAR, LOOK
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import cost_of, gain_needed
from hydrolek_drake.diagnosis.hollows import deepest, strayed
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.overlooked import enlargeable, overlooked
from hydrolek_drake.diagnosis.pulled_fits import let_go
from hydrolek_drake.diagnosis.search import LAW_COSTS, search_on
from hydrolek_drake.diagnosis.splitting import mixed
from hydrolek_drake.diagnosis.unsticking import from_other_sizes, pulled_from_own
from hydrolek_drake.diagnosis.weighing import NEARER
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

UNLIKELY = 0.001
"""What is less probable than this is not fitted to more data beside the model that explains them."""


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
    return whole(
        attempted(
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
    if not unexcited(known.conclusion):
        return None
    say("the held-out recording shows more than the training data: fitting parts of both")
    both, kept = mixed(known.bench.training, known.held_out)
    second = whole(attempt(known.bench.with_training(both), candidates, kept, say))
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


def by_both_as_found(
    known: Known, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> Known | None:
    """The search gone on with in parts of both data, from effects that explain the training data and fail ahead.

    Where a joint stuck by a hair's breadth, a small change of the same model explains both. So it does where the
    training data do not tell a number of the machine that the held-out data ask for; then what was nearly as probable
    is fitted to both, too. None where the model does not: then others, or physics in no list, are looked for.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    best = known.conclusion.best
    explaining = best.hypothesis.effects and best.hypothesis.fit.over_noise <= EXPLAINED
    failing = known.conclusion.verdict == "unlisted_physics" or unexcited(known.conclusion)
    if not (explaining and failing):
        return None
    both, kept = mixed(known.bench.training, known.held_out)
    again = known.bench.with_training(both)
    fitted = again.refit(best.hypothesis, again.fine, 2 * LOOK)
    sized = from_other_sizes(again, fitted, up_to=FAR)
    fitted = min([fitted, *sized], key=lambda h: h.fit.objective)
    if fitted.fit.over_noise > ABOVE_NOISE:
        return None  # what only imitates the missing physics hardly reaches the noise of both
    say("fitted to parts of both recordings the same model explains both: going on from there")
    rivals = [j.hypothesis for j in known.judged if j is not best and j.probability > UNLIKELY]
    fits = [known.found.baseline, *rivals, fitted]
    return _gone_on(known, again, fits, kept, candidates, say, accounted=True)


def by_own_numbers(known: Known, candidates: Sequence[Candidate], say: Callable[[str], None]) -> Known | None:
    """The search gone on with from the rig's own numbers, where effects that were found go astray ahead.

    The nominal model had bent its numbers before the effects were there, and their fit may have ended in a hollow.
    Where the noise is told too high that looks as if nothing was left, so that nothing led it on
    (`improving.lead_on`). So are effects that explain more of the training data than those that are named, and were
    dismissed for what they predict. What their numbers' uncertainty accounts for is explained; more data are asked then
    (`by_more_data`). None where nothing else explains more.

    Args:
        known: what was found.
        candidates: every effect that may be missing.
        say: told what is being done.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    bench, named, most = known.bench, known.conclusion.best.hypothesis, known.found.best
    astray = [named] if known.conclusion.best.over_noise > PREDICTED else []
    if named.ids in known.found.hypotheses and most.ids != named.ids:
        as_searched = known.found.hypotheses[named.ids].fit
        if as_searched.objective - most.fit.objective > gain_needed(most.fit):
            astray.append(most)
    astray = [h for h in astray if h.effects]
    if not astray:
        return None
    say("fitting what goes astray on held-out data from the rig's own numbers")

    def led(model: Hypothesis) -> Hypothesis | None:
        """Fitted from there, if that explains more."""
        as_it_is = bench.refit(model, bench.fine, 1)
        near = pulled_from_own(bench, model, bench.fine, bench.training)
        other = bench.refit(let_go(bench, near), bench.fine, LOOK)
        return other if as_it_is.fit.objective - other.fit.objective > gain_needed(other.fit) else None

    better = [h for h in bench.side_by_side(led, astray) if h is not None]
    if not better:
        return None
    fits = [known.found.baseline, *better]
    second = _gone_on(known, bench, fits, known.held_out, candidates, say, accounted=True)
    if second is None or second.conclusion.best.unaccounted >= known.conclusion.best.unaccounted:
        return None
    return second


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

    None where no effect does better ahead.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    best, bench = known.conclusion.best, known.bench
    if not enlargeable(best):
        return None
    say("looking for effects that promised nothing")
    better = overlooked(bench, best, candidates, known.held_out)
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
    *,
    accounted: bool = False,
) -> Known | None:
    """A search from the best of some fits; None where what it ends with explains the held-out data no better.

    If it is said so, what the parameters' uncertainty accounts for is explained, and need not do better than before.
    """
    found = Search(scores=known.found.scores)
    for fitted in bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), fits):
        found.keep(fitted)
    found.weighed_at = found.baseline.fit.over_noise
    second = whole(
        attempted(bench, found, lambda: search_on(bench, candidates, found, found.best, say), held_out, say)
    )
    second = replace(second, conclusion=conclude(second.judged, accounted=accounted))
    if second.conclusion.verdict == "unlisted_physics":
        return None
    better = second.conclusion.best.unaccounted < known.conclusion.best.unaccounted
    return second if better or accounted else None
