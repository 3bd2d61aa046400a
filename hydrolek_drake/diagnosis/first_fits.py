"""First fits with some effects: a few steps from each place where they may begin."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import GLANCE, LOOK
from hydrolek_drake.diagnosis.moments import begun
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled
from hydrolek_drake.diagnosis.unsticking import LED_STEP, begun_anew, different, own_values
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.problem import DIVERGED


@dataclass(eq=False)
class Trial:
    """Effects to be tried together.

    Attributes:
        effects: the one that is new last.
        gain: fall of the squared residuals that is promised.
        starts: where their fits may begin, full path -> value.
        left: squared residuals that are promised from each start; infinite where nothing is known.
    """

    effects: tuple[Candidate, ...]
    gain: float = 0.0
    starts: list[dict[str, float]] = field(default_factory=list)
    left: list[float] = field(default_factory=list)

    def may_begin(self, start: dict[str, float], left: float = math.inf) -> None:
        """One more start."""
        self.starts.append(start)
        self.left.append(left)

    @property
    def likeliest(self) -> dict[str, float]:
        """The start that promises to leave least."""
        return self.starts[self.left.index(min(self.left))]


def glance(bench: Workbench, trial: Trial, step: float) -> Hypothesis:
    """A few steps from each start."""
    effects, starts = trial.effects, trial.starts
    if effects[-1].effect.sudden:
        return sudden(bench, effects, starts[0], step)
    part = bench.beginning()
    near = begun(bench, effects, starts, step)
    moments = {free.path: near[free.path] for free in effects[-1].moments}
    others = different([{**start, **moments} for start in starts])[1:]
    fits = [
        bench.fit(effects, start, step, GLANCE, tolerance=1e-3, experiments=part, alone=True)
        for start in (near, *others[:1])
    ]
    best = min(fits, key=lambda h: h.fit.objective)
    if not diverged(best):
        return best
    # a start that promises most may be one that no rollout survives, such as a base that rocks faster than the step
    elsewhere = [{**near, **start} for start in effects[-1].starts]
    return min(
        [best, *(bench.fit(effects, start, step, GLANCE, 1e-3, part, alone=True) for start in elsewhere)],
        key=lambda h: h.fit.objective,
    )


def anew(bench: Workbench, trial: Trial, step: float) -> Hypothesis:
    """Effects fitted from the rig's own values of the joint, see `own_values`."""
    effects = trial.effects
    if effects[-1].effect.sudden:
        return bench.refit(sudden(bench, effects, trial.starts[0], step), step, LOOK)
    return bench.fit(effects, own_values(bench, effects, trial.likeliest), step, LOOK)


def anew_pulled(bench: Workbench, trial: Trial, step: float) -> Hypothesis:
    """Effects fitted from the rig's own values and where their searches begin, a few steps with pulled rollouts ahead.

    A nominal model near the noise may have bent its parameters so far to make up for what is missing that hardly
    anything speaks for the effect from there; with free rollouts the way from the rig's own values is long.
    """
    part = bench.beginning()
    starts = begun_anew(bench, trial.effects, trial.likeliest)
    return bench.refit(fit_pulled(bench, trial.effects, starts, step, part), step, GLANCE, alone=True)


def sudden(
    bench: Workbench, effects: Sequence[Candidate], begin: dict[str, float], step: float
) -> Hypothesis:
    """First fits with a sudden effect: from where the model without it was fitted, and anew with each of its sizes.

    What it does is no small change of what the model does without it, so that there is no way downhill from there.
    """
    part = bench.beginning()
    own = own_values(bench, effects, begin)
    starts = [begin, *({**own, **start} for start in effects[-1].starts)]
    finer = min(step, LED_STEP * bench.fine)  # a contact that opens is stiff
    fits = [bench.fit(effects, start, finer, LOOK, 1e-3, part, alone=True) for start in starts]
    return min(fits, key=lambda h: h.fit.objective)


def diverged(hypothesis: Hypothesis) -> bool:
    """Whether a rollout broke down."""
    return bool(np.max(np.abs(hypothesis.fit.residuals), initial=0.0) >= DIVERGED)
