"""The search for effects: add one at a time, several hypotheses abreast, and try to remove each again.

Everything here is fitted to the training data alone; which hypothesis is right is decided elsewhere, on data
that none of them was fitted to (`evidence`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import AT_NOISE, BEAM, FAR, LOOK, NEAR, NEARLY, POLISH
from hydrolek_drake.diagnosis.growing import HOPELESS, MOST_EFFECTS, gain_needed, grow, redundant
from hydrolek_drake.diagnosis.lessening import lessened
from hydrolek_drake.diagnosis.ranges import at_the_end, replaced, widened
from hydrolek_drake.diagnosis.score import Score, scores_of
from hydrolek_drake.diagnosis.unsticking import different, fit_pulled, led_on, of_another_joint, started_again
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench

MATERIAL_GAIN = 0.3
"""A third effect is also looked for if one promises to take this share of the squared residuals: far from the noise,
as on real machines. Where several signals count alike, of one signal's part of them."""

MOST_GROWN = 5
"""So many times at most one effect more is added. What is pruned again may have led the rest to a better place, from
which others promise more."""

FIRST_SHARE = 0.1
"""A first effect must take this share of the squared residuals of a nominal model that is far from the noise, or no
second one is looked for: of two effects, one alone takes much of what both do."""

EXCHANGED = 3
"""So many effects are tried in the place of each one of a model to which none may be added."""

NEARER = 0.5
"""A model that leaves this share of what the one left by which the data are weighed tells their noise better."""

MOST_WIDENED = 3
"""So many times in turn: 64 times what a worn machine may have."""

STUCK = 0.1
"""A fit was stuck if leading it on takes this share of what it leaves above the noise; if it was not, the land is
smooth, and no further one is led on."""


@dataclass
class Search:
    """What was tried.

    Attributes:
        hypotheses: every set of effects that was fitted with the rig's own step, by its key.
        scores: of the effects against the fitted nominal model.
        left: gains of the effects that the best model has not.
        rounds: how many times models with one effect more were fitted.
        extended: models to which one effect more was added, with the squared residuals that they left then.
        given_up: sets of effects that were too far behind after a few steps.
        smooth: whether a fit that was led on proved not to have been stuck.
        weighed_at: what the model left, over the noise, by which the data are weighed.
    """

    hypotheses: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    scores: list[Score] = field(default_factory=list)
    left: list[Score] = field(default_factory=list)
    rounds: int = 0
    extended: dict[frozenset[str], float] = field(default_factory=dict)
    given_up: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    smooth: bool = False
    weighed_at: float = 0.0

    def keep(self, hypothesis: Hypothesis) -> None:
        """Remember it if it is the best fit of these effects."""
        known = self.hypotheses.get(hypothesis.ids)
        if known is None or hypothesis.fit.objective < known.fit.objective:
            self.hypotheses[hypothesis.ids] = hypothesis

    def forget(self, wide: Candidate) -> None:
        """Drop what was fitted with a narrower range of an effect."""
        for known in (self.hypotheses, self.given_up):
            for key in [key for key in known if wide.size_path in key]:
                del known[key]
        for scores in (self.scores, self.left):
            scores[:] = [
                replace(s, candidate=wide) if s.candidate.size_path == wide.size_path else s for s in scores
            ]

    @property
    def baseline(self) -> Hypothesis:
        """The nominal model, fitted."""
        return self.hypotheses[frozenset()]

    @property
    def best(self) -> Hypothesis:
        """Best fit to the training data with each effect's parameters charged for."""
        return min(self.hypotheses.values(), key=cost_of)


def cost_of(hypothesis: Hypothesis) -> float:
    """Squared residuals plus what chance alone would gain by so many parameters, chosen among many."""
    gain = gain_needed(hypothesis.fit)
    return hypothesis.fit.objective + gain * len(hypothesis.effects) + 2.0 * hypothesis.extra


def search(
    bench: Workbench, candidates: Sequence[Candidate], found: Search, say: Callable[[str], None]
) -> None:
    """Search the effects that explain the training data.

    Args:
        bench: data, rig and fits.
        candidates: every effect that may be added.
        found: empty; filled as the search goes on, so that an interrupt loses nothing.
        say: told what is being done.
    """
    say("fitting the nominal model")
    baseline = fit_baseline(bench)
    found.keep(baseline)
    found.weighed_at = baseline.fit.over_noise
    say("trying what could explain the rest")
    found.scores = scores_of(bench, baseline, candidates, bench.fine)
    found.left = found.scores
    _go_on(bench, candidates, found, [baseline], say)


def search_on(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Search,
    elsewhere: Hypothesis,
    say: Callable[[str], None],
) -> None:
    """Go on with a search that ended, from a model that was found elsewhere.

    Args:
        bench: data, rig and fits.
        candidates: every effect that may be added.
        found: what was tried; goes on being filled.
        elsewhere: the model, fitted to these data.
        say: told what is being done.
    """
    found.keep(elsewhere)
    _weigh_anew(bench, found)
    _prune(bench, found, candidates)
    found.left = scores_of(bench, found.best, candidates, bench.fine)
    found.rounds = 1
    _go_on(bench, candidates, found, [found.best], say)


def _go_on(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Search,
    beam: list[Hypothesis],
    say: Callable[[str], None],
) -> None:
    """Add effects to the models of the beam as long as that pays."""
    while beam:
        while found.rounds < MOST_GROWN and _worth_going_on(found, MATERIAL_GAIN / bench.alike):
            candidates, beam = _grown(bench, found, beam, candidates, say)
        beam = _exchanged(bench, found, candidates)


def _grown(
    bench: Workbench,
    found: Search,
    beam: Sequence[Hypothesis],
    candidates: Sequence[Candidate],
    say: Callable[[str], None],
) -> tuple[Sequence[Candidate], list[Hypothesis]]:
    """Add one effect to the models of the beam; the candidates, some with wider ranges, and the next beam."""
    found.rounds += 1
    found.extended.update({h.ids: h.fit.objective for h in beam})
    say(f"fitting models with {_words(1 + len(found.best.effects))}")
    more = grow(bench, beam, candidates, found.scores, found.best.fit.over_noise)
    found.given_up.update(more.given_up)
    for hypothesis in more.hypotheses:
        found.keep(hypothesis)
    _prune(bench, found, candidates)
    candidates = _further(bench, found, candidates, say)
    _weigh_anew(bench, found)
    pruned = found.best
    if pruned.fit.over_noise > AT_NOISE:
        _widen(bench, found, pruned, candidates)
        _lead_on(bench, found)
    if found.best.ids != pruned.ids:  # in its place an effect may have become needless
        _prune(bench, found, candidates)
    found.left = scores_of(bench, found.best, candidates, bench.fine)
    if found.best.fit.over_noise < NEAR:
        return candidates, [found.best]
    grown = [found.hypotheses[h.ids] for h in more.hypotheses if h.ids in found.hypotheses]
    least = min((h.fit.objective for h in grown), default=0.0)
    near = [h for h in grown if h.fit.objective < HOPELESS * least]
    if found.best.ids not in {h.ids for h in near}:
        near = [found.best, *near]
    return candidates, near[:BEAM]


def _weigh_anew(bench: Workbench, found: Search) -> None:
    """Weigh the training data by the best model, and fit again with these weights what is near it.

    What a model far from the noise leaves moves fast, and some of it passes for noise. And what is known of other
    joints that move at the same time is a share of what they do: beside a model in which they do more, such as a supply
    that they share, more is unknown.
    """
    best = found.best
    together = any(experiment.others is not None for experiment in bench.training)
    if not together and best.fit.over_noise > NEARER * found.weighed_at:
        return
    bench.training = tuple(bench.weighted_by(best, bench.training))
    near = [h for h in found.hypotheses.values() if h.fit.objective < HOPELESS * best.fit.objective]
    chosen = {h.ids: h for h in (found.baseline, best, *near)}
    again = bench.side_by_side(
        lambda h: bench.refit(h, bench.fine, POLISH if h.fit.over_noise < FAR else 1), list(chosen.values())
    )
    found.given_up.update(found.hypotheses)
    found.hypotheses.clear()
    for fitted in again:
        found.keep(fitted)
    found.weighed_at = found.best.fit.over_noise


def _words(count: int) -> str:
    return {1: "one effect", 2: "two effects"}.get(count, f"{count} effects")


def _worth_going_on(found: Search, material: float) -> bool:
    """Whether anything is left over, and some effect promises to take a part of it."""
    best = found.best
    before = found.extended.get(best.ids)
    if before is not None and before - best.fit.objective < gain_needed(best.fit):
        return False  # one effect more did not pay
    if not found.left or len(best.effects) == MOST_EFFECTS:
        return False
    if (
        found.rounds == 1
        and best.fit.over_noise > FAR
        and best.fit.objective > (1.0 - FIRST_SHARE) * found.baseline.fit.objective
    ):
        return False
    promised = found.left[0].gain
    if len(best.effects) >= 2 and best.fit.over_noise > NEARLY and promised < material * best.fit.objective:
        return False
    return promised > gain_needed(best.fit)


def _prune(bench: Workbench, found: Search, candidates: Sequence[Candidate]) -> None:
    """Fit the best hypothesis again with less, as long as that makes it another one."""
    for _ in range(MOST_EFFECTS):
        best = found.best
        for fitted in lessened(bench, best, candidates):
            found.keep(fitted)
        if found.best.ids == best.ids:
            break


def _further(
    bench: Workbench, found: Search, candidates: Sequence[Candidate], say: Callable[[str], None]
) -> Sequence[Candidate]:
    """The candidates, with wider ranges for effects of the best model that ended at the end of theirs, see `ranges`.

    The best model is fitted again with them; others that have such an effect are forgotten.
    """
    for _ in range(MOST_WIDENED):
        best = found.best
        narrow = at_the_end(best) if best.fit.over_noise > AT_NOISE else []
        if not narrow:
            break
        say(f"searching further for {' and '.join(c.effect.title for c in narrow)}: its range was too narrow")
        effects: tuple[Candidate, ...] = best.effects
        wide = [widened(c) for c in narrow]
        for candidate in wide:
            candidates, effects = replaced(candidates, candidate), replaced(effects, candidate)
        fitted = bench.fit(effects, best.values, bench.fine, LOOK)
        for candidate in wide:  # only now: an interrupt of the fit loses nothing
            found.forget(candidate)
        found.keep(fitted)
        _prune(bench, found, candidates)
    return candidates


def _exchanged(bench: Workbench, found: Search, candidates: Sequence[Candidate]) -> list[Hypothesis]:
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
    _prune(bench, found, candidates)
    found.left = scores_of(bench, found.best, candidates, bench.fine)
    return [found.best]


def _widen(bench: Workbench, found: Search, hypothesis: Hypothesis, candidates: Sequence[Candidate]) -> None:
    """Fit the best hypothesis again with what contains one of its effects, from where that effect has led.

    The wider effect may have been tried from far off and got stuck; the special case leads near. Pulled rollouts
    lead on, see `unsticking.unstuck`.
    """
    work: list[tuple[tuple[Candidate, ...], dict[str, float]]] = []
    for effect in hypothesis.effects:
        rest = hypothesis.without(effect)
        kept = {k: v for k, v in hypothesis.values.items() if not k.startswith(f"{effect.path}.")}
        for wider in candidates:
            if not effect.is_special_case_of(wider):
                continue
            carried = wider.taken_over(effect, hypothesis.values)
            starts = different([{**kept, **start, **carried} for start in wider.starts])
            work += [((*rest, wider), start) for start in starts]
    pulled = bench.side_by_side(
        lambda item: fit_pulled(bench, item[0], [item[1]], bench.fine, bench.training), work
    )
    ahead: dict[frozenset[str], Hypothesis] = {}
    for near in sorted(pulled, key=lambda h: h.fit.objective):
        ahead.setdefault(near.ids, near)
    for fitted in bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), list(ahead.values())):
        found.keep(fitted)


def _lead_on(bench: Workbench, found: Search) -> None:
    """Fit the best hypothesis again where it is near the noise but not at it.

    First from the rig's own values, since the nominal parameters may have gone astray before the effects were there;
    then see `unsticking.led_on`.
    """
    best = found.best
    if not best.effects or not AT_NOISE < best.fit.over_noise < FAR:
        return
    joints = bench.joints_of(best.effects)
    kept = {k: v for k, v in best.values.items() if ".effects." in k or of_another_joint(k, joints)}
    again = fit_pulled(bench, best.effects, [kept], bench.fine, bench.training)
    for _ in range(2):
        again = bench.refit(again, bench.fine, LOOK)
    found.keep(again)
    best = found.best
    if found.smooth or best.fit.over_noise <= AT_NOISE:
        return
    led = led_on(bench, best.effects, [best.values, *started_again(best)])
    found.keep(led)
    found.smooth = best.fit.objective - led.fit.objective < STUCK * (best.fit.objective - best.fit.counted)
