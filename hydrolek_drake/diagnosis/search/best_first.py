"""Best-first search among structures: what promises most evidence is fitted next, until nothing more is promised."""

from collections.abc import Callable, Sequence
from typing import Protocol

from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.enlarging import enlarged
from hydrolek_drake.diagnosis.search.nominal import fit_nominal
from hydrolek_drake.diagnosis.search.openings import Opening, opened, surely_above
from hydrolek_drake.diagnosis.search.weighed_anew import weigh_anew
from hydrolek_drake.diagnosis.settings import NOISE, Settings
from hydrolek_drake.diagnosis.structures.addition import Sized
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.cost import cost
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.lost_windows import LostWindows
from hydrolek_drake.diagnosis.structures.workbench import Workbench

EFFECTS, LAWS = "effects", "laws"
"""What structures are enlarged by."""


class Unlisted(Protocol):
    """Physics in no list that may be beside a structure."""

    def offer(self, bench: Workbench, parent: Hypothesis) -> Sequence[Sized | LostWindows]:
        """Terms of laws and lost commands that may explain what a structure leaves."""
        ...


def search_structures(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Tried,
    say: Callable[[str], None],
    unlisted: Unlisted | None = None,
) -> None:
    """Fill what is found.

    Args:
        bench: data and problems; its training data are weighed anew by what is found.
        candidates: every effect that may be missing.
        found: receives what was tried.
        say: told what is being done.
        unlisted: physics in no list; None for none.
    """
    say("fitting the nominal model")
    fit_nominal(bench, found)
    done: set[tuple[frozenset[str], str]] = set()
    seen: dict[tuple[frozenset[str], str], Opening] = {}
    expansions = 0
    while expansions < bench.settings.most_expansions:
        openings: list[Opening] = []
        wanted = _open(bench, found, done, laws=unlisted is not None)
        for parent, kind in sorted(wanted, key=lambda each: each[1] == LAWS):
            key = (parent.ids, kind)
            lead = [o for o in openings if o.worth_while and o.leads(found.best, bench.settings.nearer)]
            if kind == LAWS and lead and found.gaining:
                continue  # laws are asked for where effects lead no farther
            if key not in seen or seen[key].parent is not parent:
                own: Sequence[Sized | LostWindows] = candidates
                if kind == LAWS and unlisted is not None:
                    own = unlisted.offer(bench, parent)
                alone = len(wanted) == 1
                seen[key] = opened(bench, parent, kind, own, found, alone=alone)
            openings.append(seen[key])
        if not openings:
            break
        hopeless = [each.key for each in openings if not _to_be_followed(each, found, bench.settings)]
        done.update(hopeless)
        openings = [each for each in openings if each.key not in done]
        if not openings:
            continue
        next_ = min(openings, key=lambda each: each.expected)
        expansions += 1
        say(f"{next_.kind} beside {' + '.join(c.id for c in next_.parent.effects) or 'the nominal model'}")
        done.add(next_.key)
        enlarged(bench, next_, candidates, found)
        weigh_anew(bench, found)
        if found.rounds_without_gain(bench.settings.patience):
            break


def _to_be_followed(opening: Opening, found: Tried, settings: Settings) -> bool:
    """Whether a structure is to be enlarged.

    A law describes what has no name, and so hardly reaches the noise: it is enlarged only where a further term promises
    to lead to the noise, or a fifth nearer to it than the best structure is.
    """
    if opening.kind == LAWS and not all(isinstance(c, Candidate) for c in opening.parent.effects):
        return opening.leads(found.best, settings.nearer)
    return opening.worth_while


def _open(
    bench: Workbench, found: Tried, done: set[tuple[frozenset[str], str]], *, laws: bool
) -> list[tuple[Hypothesis, str]]:
    """Structures that may be enlarged, and by what.

    A search that goes on from another one's structures begins at the best of these. Each is enlarged by effects first,
    since a law can imitate most of them, and only the best one once it leaves nothing that is surely above the noise:
    what others lead to has more additions and can leave no less. Laws are asked for where the best one leaves so much
    that something would be called missing.
    """
    best = found.best
    if (frozenset(), EFFECTS) not in done and not found.seeds:
        return [(found.baseline, EFFECTS)]
    if best.fit.over_noise <= surely_above(bench, best):
        lawful = not all(isinstance(c, Candidate) for c in best.effects)
        items = [(best, LAWS if lawful else EFFECTS)]
    else:
        items = []
        sizes: dict[int, int] = {}
        for h in sorted(found.hypotheses.values(), key=cost):
            count = len(h.effects)
            sizes[count] = sizes.get(count, 0) + 1
            beyond = count >= bench.settings.most_additions or sizes[count] > bench.settings.beam
            if beyond or (h.effects and cost(h) >= cost(found.baseline)):
                continue
            listed = all(isinstance(c, Candidate) for c in h.effects)
            if listed and (h.ids, EFFECTS) not in done:
                items.append((h, EFFECTS))
            elif laws and best.fit.over_noise > NOISE.held_out and not _explained_by(best, h, bench.settings):
                items.append((h, LAWS))
    return [(h, kind) for h, kind in items if (h.ids, kind) not in done]


def _explained_by(best: Hypothesis, structure: Hypothesis, settings: Settings) -> bool:
    """Whether the best structure explains the data and contains one that lies behind for good.

    A law beside that one would only imitate what the best one has in effects.
    """
    behind = structure.fit.over_noise > settings.again_within * best.fit.over_noise
    return behind and best.fit.over_noise <= NOISE.explained and structure.ids < best.ids
