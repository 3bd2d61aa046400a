"""What additions promise beside a structure: in free rollouts where it was fitted, and to an observer around it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.parts import enough_for
from hydrolek_drake.diagnosis.fitting.problems import problem_of
from hydrolek_drake.diagnosis.fitting.promise import Promise, promises_at
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.settings import EVIDENCE, FITS, GAINS, NOISE, Rung
from hydrolek_drake.diagnosis.structures.addition import Sized, names_of
from hydrolek_drake.diagnosis.structures.candidates import redundant
from hydrolek_drake.diagnosis.structures.cost import cost_of, dispersion, gain_needed
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import of_additions
from hydrolek_drake.diagnosis.structures.lost_windows import LostWindows
from hydrolek_drake.diagnosis.structures.weighing import far_over_noise
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place


@dataclass(frozen=True)
class Opening:
    """A structure and what additions of one kind promise beside it.

    Attributes:
        parent: the structure.
        kind: "effects" or "laws".
        own: the additions.
        free: what they promise in free rollouts where the structure was fitted.
        pulled: what they promise to an observer around the rig's own numbers; empty where nobody has asked.
        sizes: full path -> value of what the structure adds to the nominal model.
        expected: cost of the structure that they promise.
        left: times the noise that it is promised to leave.
        lost: windows of lost commands that may be added too.
        enough: times the noise that need not be explained unless something promises to.
        far: times the noise beyond which a structure's numbers are bent.
        told: largest fall of the squares that is promised, in free rollouts or to an observer.
    """

    parent: Hypothesis
    kind: str
    own: tuple[Sized, ...]
    free: tuple[Promise, ...]
    pulled: tuple[Promise, ...]
    sizes: dict[str, float]
    expected: float
    left: float = math.inf
    lost: LostWindows | None = None
    enough: float = NOISE.at
    far: float = NOISE.far
    told: float = 0.0

    @property
    def key(self) -> tuple[frozenset[str], str]:
        """What tells it from others."""
        return self.parent.ids, self.kind

    @property
    def promising(self) -> float:
        """Largest fall of the squares that is promised, in free rollouts."""
        return self.free[0].gain if self.free else 0.0

    def leads(self, best: Hypothesis, nearer: float) -> bool:
        """Whether it promises to lead to the noise, or so much nearer to it than the best structure is.

        Args:
            best: of all so far.
            nearer: share of what that one leaves.
        """
        return self.left <= max(NOISE.at, nearer * best.fit.over_noise)

    @property
    def worth_while(self) -> bool:
        """Whether a structure leaves more than noise, or an addition promises to take what it must of the rest.

        Of a structure that has additions and is near the noise promises hold: one beside which nothing promises what a
        further addition must bring lacks none, whatever keeps it from the noise.
        """
        if not self.own or not _worth_while(self.parent, self.own[0], self.promising, self.enough):
            return False
        fit = self.parent.fit
        holds = bool(self.parent.effects) and fit.over_noise <= self.far
        return not holds or self.told >= GAINS.promising * self.own[0].cost * gain_needed(fit)


def opened(
    bench: Workbench,
    parent: Hypothesis,
    kind: str,
    additions: Sequence[Sized | LostWindows],
    found: Tried,
    *,
    alone: bool = False,
) -> Opening:
    """See what additions promise beside a structure.

    Args:
        bench: data and problems.
        parent: the structure, fitted.
        kind: "effects" or "laws".
        additions: effects, or terms of laws.
        found: receives what effects promise.
        alone: whether it is enlarged whatever others promise.
    """
    lost = next((c for c in additions if isinstance(c, LostWindows)), None)
    sized = [c for c in additions if not isinstance(c, LostWindows)]
    own = tuple(c for c in sized if c.size_path not in parent.ids and not redundant(parent.effects, c))
    sizes = of_additions(parent.values)
    if not own:
        return Opening(parent, kind, (), (), (), sizes, math.inf)
    exact = Rung(math.inf, 1.0, math.inf, 0, 1)
    place = descend([_place(bench, parent, exact, parent.fit.unit)], 0, bench.pool, bench.cores)[0]
    free = promises_at(bench, place, parent.effects, own)
    if kind == "effects":
        found.left = free
    pulled: list[Promise] = []
    shares = [_share(free[0].gain, parent.fit.objective, parent.fit.counted)]
    asked = parent.fit.over_noise > NOISE.at and not alone
    enough = surely_above(bench, parent)
    if asked and _worth_while(parent, own[0], free[0].gain, enough):
        pulled, share = observed(bench, parent, own)
        shares.append(share)
        if lost is not None:
            shares.append(lost.share)
    excess = max(parent.fit.objective - parent.fit.counted, 0.0)
    count = max(parent.fit.counted, 1)
    left = max(parent.fit.objective - max(shares) * excess, count)
    needed = gain_needed(parent.fit)
    costs = sum(c.cost for c in parent.effects) + own[0].cost
    expected = cost_of(parent.fit, left, costs)
    trace(
        f"  open {kind} beside {names_of(parent.effects)} {parent.fit.over_noise:.4f}, expected "
        f"{math.sqrt(left / count):.3f}: needed {needed:.0f}; free "
        + ", ".join(f"{p.candidate.id} {p.gain:.0f}" for p in free[:4])
        + "; pulled "
        + ", ".join(f"{p.candidate.id} {p.gain:.0f}" for p in pulled[:4])
    )
    over_noise = math.sqrt(left / count)
    told = max(free[0].gain, max(shares) * excess)
    return Opening(
        parent,
        kind,
        own,
        tuple(free),
        tuple(pulled),
        sizes,
        expected,
        left=over_noise,
        lost=lost,
        enough=enough,
        far=far_over_noise(bench.training),
        told=told,
    )


def surely_above(bench: Workbench, structure: Hypothesis) -> float:
    """Above so many times the noise a structure is enlarged even if nothing is promised.

    Noise is known to but a share. A nominal model that leaves more may be bent so that what it lacks promises nothing;
    one with an addition that leaves less than what would be called missing, and beside which nothing promises anything,
    is right. A machine that is cut at its supply, or whose equations leave more at best, is held to that (`parts`).
    """
    enough = enough_for(bench)
    if enough > NOISE.at:
        return enough
    return NOISE.held_out if structure.effects else NOISE.at


def _worth_while(parent: Hypothesis, addition: Sized, promised: float, enough: float) -> bool:
    """See `Opening.worth_while`; so near the noise promises hold, and chance is paid for as in `evidence.judged`."""
    fit = parent.fit
    flatter = dispersion(fit.objective, fit.counted, len(fit.unit))
    odds = EVIDENCE.effect_cost * addition.cost + EVIDENCE.parameter_cost
    needed = max(addition.cost * gain_needed(fit), 2.0 * odds * flatter)
    return fit.over_noise > enough or promised >= GAINS.promising * needed


def _share(gain: float, objective: float, counted: int) -> float:
    """Which share of what is left above the noise a gain takes."""
    excess = objective - counted
    return min(gain / excess, 1.0) if excess > 2.0 * NOISE.known * counted else 0.0


def observed(bench: Workbench, parent: Hypothesis, own: Sequence[Sized]) -> tuple[list[Promise], float]:
    """What additions promise to an observer around the rig's own numbers, and the share that the best one takes."""
    first = replace(bench.settings.continued[1], coarse=FITS.coarse)
    parameters = bench.parameters(parent.effects)
    unit = np.clip(parameters.unit(of_additions(parent.values)), FITS.negligible, 1.0 - FITS.negligible)
    near = descend([_place(bench, parent, first, unit)], 2, bench.pool, bench.cores)[0]
    pulled = promises_at(bench, near, parent.effects, own)
    return pulled, _share(pulled[0].gain, near.objective, near.problem.counted)


def _place(bench: Workbench, structure: Hypothesis, rung: Rung, unit: np.ndarray) -> Place:
    problem = problem_of(bench, structure.effects, rung)
    return Place(problem, bench.movable(structure.effects, problem.parameters), unit)
