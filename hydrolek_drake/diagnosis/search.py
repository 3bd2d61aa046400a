"""The search for effects: add one at a time, several hypotheses abreast, and try to remove each again.

Everything here is fitted to the training data alone; which hypothesis is right is decided elsewhere, on data
that none of them was fitted to (`evidence`).
"""

from collections.abc import Callable, Sequence
from typing import Protocol

from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.beginning import shown_by
from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import (
    ABOVE_NOISE,
    AT_NOISE,
    BEAM,
    FALLING,
    FAR,
    HOPELESS,
    MOST_EFFECTS,
    NEAR,
    NEARLY,
)
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.growing import grow
from hydrolek_drake.diagnosis.improving import (
    exchanged,
    lead_on,
    prune,
    searched_further,
    widen,
    widen_where_promised,
)
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.score import scores_of
from hydrolek_drake.diagnosis.weighing import weigh_anew
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench


class Other(Protocol):
    """What explains what the nominal model leaves, other than effects of the list."""

    def __call__(self, nominal: Hypothesis, effects: int, /) -> FoundLaw | None:
        """A law of the machine, where so many effects do not explain the data."""

    def lost(self, nominal: Hypothesis, /) -> FoundLaw | None:
        """Commands that got lost."""


MATERIAL_GAIN = 0.3
"""A third effect is also looked for if one promises to take this share of the squared residuals: far from the noise,
as on real machines. Where several signals count alike, of one signal's part of them."""

MOST_GROWN = 5
"""So many times at most one effect more is added. What is pruned again may have led the rest to a better place, from
which others promise more."""

LAW_COSTS = 2
"""A law costs as much as so many listed effects: where it enters and what it depends on are both chosen among many."""

FIRST_SHARE = 0.1
"""A first effect must take this share of the squared residuals of a nominal model that is far from the noise, or no
second one is looked for: of two effects, one alone takes much of what both do."""


def search(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Search,
    say: Callable[[str], None],
    other: Other | None = None,
) -> None:
    """Search the effects that explain the training data.

    Args:
        bench: data, rig and fits.
        candidates: every effect that may be added.
        found: empty; filled as the search goes on, so that an interrupt loses nothing.
        say: told what is being done.
        other: asked before a second and a third effect are added, what else explains the data.
    """
    say("fitting the nominal model")
    baseline = fit_baseline(bench)
    found.keep(baseline)
    found.weighed_at = baseline.fit.over_noise
    bench.first_s = shown_by(baseline.fit.residuals, bench.training)
    say("trying what could explain the rest")
    found.scores = scores_of(bench, baseline, candidates, bench.fine)
    found.left = found.scores
    _go_on(bench, candidates, found, [baseline], say, other)


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
    weigh_anew(bench, found)
    prune(bench, found, candidates)
    found.left = scores_of(bench, found.best, candidates, bench.fine)
    found.rounds = 1
    _go_on(bench, candidates, found, [found.best], say)


def _go_on(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Search,
    beam: list[Hypothesis],
    say: Callable[[str], None],
    other: Other | None = None,
) -> None:
    """Add effects to the models of the beam as long as that pays, and nothing else explains the data."""
    material = MATERIAL_GAIN / bench.alike
    while beam:
        while found.rounds < MOST_GROWN and _worth_going_on(found, material):
            candidates, beam = _grown(bench, found, beam, candidates, say)
            if not found.repeated and _moved_since(found) and _worth_going_on(found, material):
                found.repeated, found.rounds = True, found.rounds - 1
                continue
            found.law = None if other is None else _explained_otherwise(other, found, material)
            if found.law is not None:
                return
        beam = exchanged(bench, found, candidates)


def _moved_since(found: Search) -> bool:
    """Whether the best model was led lower after effects had been tried beside it, which may promise more there."""
    before = found.extended.get(found.best.ids)
    return before is not None and before - found.best.fit.objective >= gain_needed(found.best.fit)


def _explained_otherwise(other: Other, found: Search, material: float) -> FoundLaw | None:
    """What explains the data better than the effects found so far, other than more of them; None if nothing does.

    What is the recordings' own, such as commands that got lost, has numbers for every time that it happens, far more
    than two effects have, so that two are tried before.
    """
    questions: list[Callable[[], FoundLaw | None]] = []
    if _something_else_may_do(found, material):
        questions.append(lambda: other(found.baseline, found.rounds))
    if _lost_may_do(found, material):
        questions.append(lambda: other.lost(found.baseline))
    told = (question() for question in questions)
    return next((law for law in told if law is not None and outdoes(law, found.best)), None)


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
    prune(bench, found, candidates)
    candidates = searched_further(bench, found, candidates, say)
    weigh_anew(bench, found)
    pruned = found.best
    if pruned.fit.over_noise > AT_NOISE:
        widen(bench, found, pruned, candidates)
        lead_on(bench, found)
        if bench.together and _moved_on(pruned, found.best):
            weigh_anew(bench, found)
    if found.best.fit.over_noise < NEAR:
        widen_where_promised(bench, found, candidates)
    if found.best is not pruned:  # in its place an effect may have become needless
        prune(bench, found, candidates)
    found.left = scores_of(bench, found.best, candidates, bench.fine)
    if not found.best.effects:  # effects may have led the nominal model to where others promise more
        found.scores = found.left
    if found.best.fit.over_noise < NEAR:
        return candidates, [found.best]
    grown = [found.hypotheses[h.ids] for h in more.hypotheses if h.ids in found.hypotheses]
    least = min((h.fit.objective for h in grown), default=0.0)
    near = [h for h in grown if h.fit.objective < HOPELESS * least]
    if found.best.ids not in {h.ids for h in near}:
        near = [found.best, *near]
    return candidates, near[:BEAM]


def outdoes(law: FoundLaw, best: Hypothesis) -> bool:
    """Whether a law beside the nominal model explains the training data better than listed effects do, at its cost.

    A small sine can make up for what a small effect does to one recording.

    Args:
        law: fitted to the training data.
        best: the model with effects that explains them best.
    """
    # the law's data are weighed by what the nominal model leaves, so that multiples of the noise are compared
    left, needed = law.fit.over_noise**2 * best.fit.counted, gain_needed(best.fit)
    return left + needed * LAW_COSTS < best.fit.objective + needed * len(best.effects)


def _moved_on(before: Hypothesis, after: Hypothesis) -> bool:
    """Whether a fit has taken `FALLING` of what was left beyond the noise."""
    return after.fit.over_noise - 1.0 < (1.0 - FALLING) * (before.fit.over_noise - 1.0)


def _words(count: int) -> str:
    return {1: "one effect", 2: "two effects"}.get(count, f"{count} effects")


def _something_else_may_do(found: Search, material: float) -> bool:
    """Whether one effect leaves something or two do: a further one would be added next, or one alone is far off."""
    if found.rounds == 1 and found.best.fit.over_noise > EXPLAINED:
        return True
    return found.rounds <= 2 and _worth_going_on(found, material)


def _lost_may_do(found: Search, material: float) -> bool:
    """Whether two effects leave something, or one does and no second one is tried."""
    if found.rounds == 1:
        return found.best.fit.over_noise > EXPLAINED and not _worth_going_on(found, material)
    return found.rounds == 2 and found.best.fit.over_noise > ABOVE_NOISE


def _worth_going_on(found: Search, material: float) -> bool:
    """Whether anything is left over, and some effect promises to take a part of it.

    Near the noise, but above it, a model may have bent its numbers so far that nothing promises anything beside it;
    from the rig's own numbers an effect may still do better (`growing`).
    """
    best = found.best
    if best.ids in found.extended and not _moved_since(found):
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
    return promised > gain_needed(best.fit) or ABOVE_NOISE < best.fit.over_noise < NEAR
