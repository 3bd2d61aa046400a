"""A search that begins where the chain is cut: behind the recorded pressure of a pump, and then the supply too.

A line between a pump and its relief valve rings, so that uncut rollouts have local minima for every oscillation that
the supply's numbers are off. With the recorded pressure in place of the supply there are none of these, and what lies
behind it shows what it lacks. Then the supply's numbers are found under the flow that this draws, and the search goes
on among what the supply may lack.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from hydrolek_drake.diagnosis.fitting.behind_cut import behind_of
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.parts import acts_behind, behind_supply, supply_before
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.search.best_first import Unlisted, search_structures
from hydrolek_drake.diagnosis.structures.addition import Sized
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.lost_windows import LostWindows
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def search_machine(
    bench: Workbench,
    candidates: Sequence[Candidate],
    found: Tried,
    say: Callable[[str], None],
    unlisted: Unlisted | None = None,
) -> None:
    """Fill what is found; as `search_structures`, behind the cut first where there is one.

    Args:
        bench: data and problems; its training data are weighed anew by what is found.
        candidates: every effect that may be missing.
        found: receives what was tried.
        say: told what is being done.
        unlisted: physics in no list; None for none.

    Raises:
        KeyboardInterrupt: what was found by then is in `found`, unless nothing was.
    """
    part = behind_supply(bench)
    if part is None:
        search_structures(bench, candidates, found, say, unlisted)
        return
    seen = Tried(seeds=behind_of(bench, found.seeds))
    behind = [c for c in candidates if acts_behind(bench.rig, c.size_path)]

    def told(text: str) -> None:
        say(f"behind the recorded supply pressure: {text}")

    before = [c for c in candidates if not acts_behind(bench.rig, c.size_path)]
    lawful = None if unlisted is None else _BeforeTheCut(unlisted)
    try:
        search_structures(part, behind, seen, told, unlisted)
        say("finding the supply's numbers")
        found.seeds = _with_supply(bench, seen, found.seeds)
        search_structures(bench, before, found, say, lawful)
    except KeyboardInterrupt:
        if not found.hypotheses:
            bench.resume()
            _keep_as_they_are(bench, seen, found)
        raise
    finally:
        bench.evaluations += part.evaluations
        found.left = [*found.left, *seen.left]


def _keep_as_they_are(bench: Workbench, seen: Tried, found: Tried) -> None:
    """What was found behind the cut by then, with the rig's own supply, which acts on nothing there."""
    ended = [Entrant(h.effects, h.values) for h in seen.hypotheses.values()]
    if ended:
        for each in race(bench, ended, (replace(bench.settings.again, rounds=0, keep=len(ended)),)):
            found.keep(each)


def _with_supply(bench: Workbench, seen: Tried, before: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The structures with which the search goes on, each with the supply's numbers that the best one was given.

    Args:
        bench: data and problems.
        seen: what was found behind the cut.
        before: structures fitted to other data of all of the machine.
    """
    best = seen.best
    nearest = sorted(before, key=lambda h: h.fit.over_noise)[:1]
    known = [
        {path: value for path, value in h.values.items() if not acts_behind(bench.rig, path)} for h in nearest
    ]
    supply = supply_before(bench, best.effects, best.values, known)[0]
    return [replace(h, values={**h.values, **supply}) for h in seen.near_the_best(bench.settings)]


@dataclass(frozen=True)
class _BeforeTheCut:
    """Physics in no list at the supply alone, for a machine that was searched behind it."""

    all: Unlisted

    def offer(self, bench: Workbench, parent: Hypothesis) -> Sequence[Sized | LostWindows]:
        """Terms of laws that do not count behind the cut."""
        offered = self.all.offer(bench, parent)
        return [
            each
            for each in offered
            if not isinstance(each, LostWindows) and not acts_behind(bench.rig, each.size_path)
        ]
