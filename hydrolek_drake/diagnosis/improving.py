"""The best model made better: less of it, more room, something else in place of an effect, or another way down."""

from collections.abc import Callable, Sequence

from hydrolek_drake.diagnosis.candidates import Candidate, redundant, widenings
from hydrolek_drake.diagnosis.effort import (
    AT_NOISE,
    FAR,
    LOOK,
    MOST_EFFECTS,
    NEAR,
    NEARLY,
    POLISH,
)
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import PROMISING, gain_needed
from hydrolek_drake.diagnosis.lessening import lessened
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled, let_go
from hydrolek_drake.diagnosis.ranges import at_the_end, gain_beyond, replaced, widened
from hydrolek_drake.diagnosis.score import score_in_place, scores_of
from hydrolek_drake.diagnosis.unsticking import (
    different,
    from_other_sizes,
    led_on,
    pulled_from_own,
    started_again,
)
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of

EXCHANGED = 3
"""So many effects are tried in the place of each one of a model to which none may be added."""

MOST_WIDENED = 3
"""So many times in turn: 64 times what a worn machine may have."""

STUCK = 0.1
"""A fit was stuck if leading it on takes this share of what it leaves above the noise; if it was not, the land is
smooth, and no further one is led on."""


def prune(bench: Workbench, found: Search, candidates: Sequence[Candidate]) -> None:
    """Fit the best hypothesis again with less, as long as that makes it another one."""
    for _ in range(MOST_EFFECTS):
        best = found.best
        for fitted in lessened(bench, best, candidates):
            found.keep(fitted)
        if found.best.ids == best.ids:
            break


def searched_further(
    bench: Workbench, found: Search, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> Sequence[Candidate]:
    """The candidates, with wider ranges for effects of the best model that ended at the end of theirs, see `ranges`.

    The best model is fitted again with them; others that have such an effect are forgotten. At the noise a parameter
    may only be at an end because the data do not tell it, so there it must promise something beyond.
    """
    for _ in range(MOST_WIDENED):
        best = found.best
        narrow = at_the_end(best)
        if best.fit.over_noise <= AT_NOISE:
            narrow = [c for c in narrow if gain_beyond(best, c) > gain_needed(best.fit)]
        if not narrow:
            break
        say(f"searching further for {' and '.join(c.effect.title for c in narrow)}: its range was too narrow")
        effects: tuple[Candidate, ...] = best.effects
        wide = [widened(c, best.values) for c in narrow]
        for candidate in wide:
            candidates, effects = replaced(candidates, candidate), replaced(effects, candidate)
        fitted = bench.fit(effects, best.values, bench.fine, LOOK)
        for candidate in wide:  # only now: an interrupt of the fit loses nothing
            found.forget(candidate)
        found.keep(fitted)
        prune(bench, found, candidates)
    return candidates


def exchanged(bench: Workbench, found: Search, candidates: Sequence[Candidate]) -> list[Hypothesis]:
    """Where no further effect may be added, try those that promise most in the place of each that the best model has.

    Far from the noise an effect that came first may do a little of what another one does better (stepwise regression
    with exchange). What is found so is the next beam.
    """
    best = found.best
    if len(best.effects) < MOST_EFFECTS or best.fit.over_noise < NEARLY:
        return []
    needed = gain_needed(best.fit)
    work: list[tuple[tuple[Candidate, ...], dict[str, float]]] = []
    for effect in best.effects:
        rest = best.without(effect)
        promising = [s for s in found.left if s.gain > needed and not redundant(rest, s.candidate)]
        work += [((*rest, s.candidate), {**best.values, **s.start}) for s in promising[:EXCHANGED]]
    for fitted in bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, POLISH), work):
        found.keep(fitted)
    if found.best is best:
        return []
    found.keep(bench.refit(found.best, bench.fine, LOOK))
    prune(bench, found, candidates)
    found.left = scores_of(bench, found.best, candidates, bench.fine)
    return [found.best]


def widen(bench: Workbench, found: Search, hypothesis: Hypothesis, candidates: Sequence[Candidate]) -> None:
    """Fit the best hypothesis again with what contains one of its effects, from where that effect has led.

    The wider effect may have been tried from far off and got stuck; the special case leads near. Pulled rollouts
    lead on, see `unsticking.unstuck`.
    """
    work: list[tuple[tuple[Candidate, ...], dict[str, float]]] = []
    for effect, wider, effects in widenings(hypothesis.effects, candidates):
        kept = {k: v for k, v in hypothesis.values.items() if not k.startswith(f"{effect.path}.")}
        carried = wider.taken_over(effect, hypothesis.values)
        work += [(effects, start) for start in different([{**kept, **s, **carried} for s in wider.starts])]
    pulled = bench.side_by_side(
        lambda item: fit_pulled(bench, item[0], [item[1]], bench.fine, bench.training), work
    )
    ahead: dict[frozenset[str], Hypothesis] = {}
    for near in sorted(pulled, key=lambda h: h.fit.objective):
        ahead.setdefault(near.ids, near)
    for fitted in bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), list(ahead.values())):
        found.keep(fitted)


def widen_where_promised(bench: Workbench, found: Search, candidates: Sequence[Candidate]) -> None:
    """Fit the best hypothesis near the noise again with what contains one of its effects, where that promises much.

    From there least squares with free rollouts goes straight on. If the best one has the wider effect already, that is
    fitted again from its special case: other fits may have ended where it does hardly more than that one.
    """
    best = found.best
    work: list[tuple[tuple[Candidate, ...], dict[str, float]]] = []
    for hypothesis in list(found.hypotheses.values()):
        for effect, wider, effects in widenings(hypothesis.effects, candidates):
            if hypothesis is not best and key_of(effects) != best.ids:
                continue
            score = score_in_place(bench, hypothesis, effect, wider, bench.fine)
            if score.gain > PROMISING * gain_needed(hypothesis.fit):
                work.append((effects, {**hypothesis.values, **score.start}))
    for fitted in bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, LOOK), work):
        found.keep(fitted)


def lead_on(bench: Workbench, found: Search) -> None:
    """Fit the best hypothesis again where it is near the noise but not at it.

    First from the rig's own values, since the nominal parameters may have gone astray before the effects were there;
    then with other sizes of what is sudden, see `unsticking.from_other_sizes`; then see `unsticking.led_on`.
    """
    best = found.best
    if not best.effects or not AT_NOISE < best.fit.over_noise < FAR:
        return
    again = let_go(bench, pulled_from_own(bench, best, bench.fine, bench.training))
    for _ in range(2):
        again = bench.refit(again, bench.fine, LOOK)
    found.keep(again)
    for fitted in from_other_sizes(bench, found.best, up_to=NEAR):
        found.keep(fitted)
    best = found.best
    if found.smooth or best.fit.over_noise <= AT_NOISE:
        return
    led = led_on(bench, best.effects, [best.values, *started_again(best)])
    found.keep(led)
    found.smooth = best.fit.objective - led.fit.objective < STUCK * (best.fit.objective - best.fit.counted)
