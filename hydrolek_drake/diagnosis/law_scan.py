"""At which frequencies something that shakes the machine would explain what a model leaves."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.effort import ABOVE_NOISE
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_problem import SCAN_S, Law
from hydrolek_drake.diagnosis.law_terms import TRIED, gain_along
from hydrolek_drake.diagnosis.laws import TERMS, Span, law_record
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.unsticking import pulled_from_own
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.problem import PULL_S
from hydrolek_drake.rollout.lane_view import LANES
from hydrolek_drake.rollout.lanes import roll_out_lanes

HIGHEST_HZ = 8.0
"""Frequencies up to this one are looked for; joints hardly follow faster ones."""

LOWEST = 1.0
"""Cycles at least within `SCAN_S`."""

SPACING = 0.25
"""Frequencies are tried so many cycles over the recording apart. Two half a cycle apart are hardly told from each other
by their sines alone; but the fitted parameters undo a part of both, and what is left of a peak is narrower."""

PULLED_APART = 0.5
"""The same with pulled rollouts, in which the fitted parameters undo little of a sine."""

SCANNED = ("command", "supply", "load", "sensor")
"""Inputs at which all frequencies are tried. What shakes at another one shows near the same frequencies at one of
these: a force at the rod as a moment at the load, and what changes the flow in proportion as the supply does."""

STEADY = ("capacity_a", "capacity_b", "back_a", "back_b", "ramp", "coil_time", "flow_force")
"""Inputs that say how something is built, which no disturbance shakes: no frequency is tried there."""

FOLLOWED = 6
"""So many peaks of the first part are looked at with more of the recording, where frequencies lie further apart."""

LONGER_S = 60.0
"""With so many seconds of it. Of an input both frequencies are told that promise most, with these and with the first
part: a nominal model that made up for a disturbance goes astray later on, and with it what is promised there."""

PLAIN = 0.5
"""What pulled rollouts tell must take this share of what they leave above the noise: they hide what is slow, and what
shakes is all that they are asked for."""


@dataclass(frozen=True)
class _Part:
    """The beginning of the first recording, and what of a change there the fitted parameters cannot undo."""

    experiments: list[Experiment]
    across: Across
    counted: int


@dataclass(frozen=True)
class Scan:
    """What sines promise at a model's inputs.

    Attributes:
        bench: training data and rig.
        left: the model that leaves the mismatch.
        inputs: unknown inputs of the joint.
        span: what the laws' variables are told in.
        step: of the integration [s].
        pull_time: of the rollouts [s]; None for free ones.
        apart: cycles over the first part of the recording that frequencies are tried apart.
    """

    bench: Workbench
    left: Hypothesis
    inputs: Sequence[Input]
    span: Span
    step: float
    pull_time: float | None = None
    apart: float = SPACING

    def laws(self) -> list[Law]:
        """The best sine at every input that can be shaken, or two, with what they promise."""
        bench = self.bench
        longest = min(float(np.ptp(bench.training[0].time)), LONGER_S)
        short, longer = bench.side_by_side(self._beginning, (SCAN_S, longest))
        spacing = self.apart / SCAN_S

        def scanned(given: Input) -> list[Law]:
            every = self._gains(given, short, np.arange(LOWEST / SCAN_S, HIGHEST_HZ, spacing))
            return _peaks(every)[:FOLLOWED]

        def of_frequencies(given: Input) -> list[Law]:
            here = at[given.probe] if given.probe in at else self._gains(given, short, frequencies)
            around = np.arange(-0.5 * spacing, 0.5 * spacing, SPACING / longest)
            best = sorted(here, key=_promised)[: -FOLLOWED - 1 : -1]
            near = self._gains(given, longer, np.concatenate([law.frequency + around for law in best]))
            loudest, at_first = max(near, key=_promised), max(near[: around.size], key=_promised)
            return [loudest] if loudest is at_first else [loudest, at_first]

        shaken = [given for given in self.inputs if given.probe not in STEADY]
        through = [given for given in shaken if given.probe in SCANNED] or shaken
        peaks = bench.side_by_side(scanned, through)
        at = {given.probe: found for given, found in zip(through, peaks, strict=True)}
        frequencies = np.unique([law.frequency for found in at.values() for law in found])
        return [law for laws in bench.side_by_side(of_frequencies, shaken) for law in laws]

    def _beginning(self, seconds: float) -> _Part:
        part = [self.bench.training[0].until(seconds)]
        problem = self.bench.problem(self.left.effects, self.step, part, self.pull_time)
        fit = self.left.fit
        base = problem.residuals(fit.unit)
        jacobian = problem.jacobian(fit.unit, base)
        nearby = Fit(fit.unit, base, fit.off_prior, jacobian, fit.prior_jacobian, problem.counted, 0)
        return _Part(part, Across(nearby), problem.counted)

    def _gains(self, given: Input, part: _Part, frequencies: np.ndarray) -> list[Law]:
        """What a sine of each frequency promises in all fitted data, by what it does in a part of them."""
        parameters = self.bench.parameters(self.left.effects)
        records = parameters.records(self.left.fit.unit)
        off = self.left.fit.off_prior
        counted = self.left.fit.counted

        def responses(shaken: Sequence[tuple[float, float, float]]) -> list[np.ndarray]:
            """Residuals under a sine and a cosine of a frequency each; NaN where a rollout diverged."""
            runs = []
            for sine, cosine, frequency in shaken:
                term = None if frequency else TERMS[0]
                law = law_record(
                    given.probe, self.span, term, given.scale * sine, given.scale * cosine, frequency
                )
                runs += [
                    e.run(records, self.step, pull_time=self.pull_time, law=law) for e in part.experiments
                ]
            made = iter(roll_out_lanes(runs))
            found = [
                np.concatenate([e.residuals(next(made).signals) for e in part.experiments]) for _ in shaken
            ]
            return [each if np.isfinite(each).all() else np.full_like(each, np.nan) for each in found]

        (here,) = responses([(0.0, 0.0, 0.0)])
        rest = part.across(np.concatenate([here, off]))
        still = np.zeros(off.size)
        found = []
        for begin in range(0, len(frequencies), LANES):
            self.bench.alive()
            some = frequencies[begin : begin + LANES].tolist()
            moved = responses([(*pair, f) for f in some for pair in ((TRIED, 0.0), (0.0, TRIED))])
            changes = [part.across(np.concatenate([each - here, still])) for each in moved]
            for k, frequency in enumerate(some):
                gain, amplitudes = gain_along(np.stack(changes[2 * k : 2 * k + 2], axis=1), rest)
                found.append(Law(given, (), frequency, gain * counted / max(part.counted, 1), amplitudes))
        return found


def shaking(
    bench: Workbench, left: Hypothesis, inputs: Sequence[Input], span: Span, step: float
) -> list[Law]:
    """Sines that explain what rollouts leave that are pulled to the measurements.

    A nominal model that was fitted without the disturbance has bent its numbers, and goes astray within seconds: its
    residuals hold everything but the sine. Pulled rollouts forget within `PULL_S` and hide what is slow, so that what
    shakes stands out, and the rig's own numbers do.

    Args:
        bench: training data and rig.
        left: the model that leaves the mismatch with free rollouts.
        inputs: unknown inputs of the joint.
        span: what the laws' variables are told in.
        step: of the integration [s].

    Returns:
        laws whose fits begin with pulled rollouts, with the share of what `left` leaves that they take of the pulled
        ones' rest; none where these hardly leave anything, or no sine takes `PLAIN` of it.
    """
    if all(given.probe in STEADY for given in inputs):
        return []
    part = [bench.training[0].until(LONGER_S)]
    pulled = pulled_from_own(bench, left, step, part)
    above = pulled.fit.objective - pulled.fit.counted
    if pulled.fit.over_noise <= ABOVE_NOISE or above < gain_needed(pulled.fit):
        return []
    laws = Scan(bench, pulled, inputs, span, step, PULL_S, PULLED_APART).laws()
    left_over = left.fit.objective - left.fit.counted
    return [
        replace(law, gain=left_over * min(law.gain / above, 1.0), pulled=True)
        for law in laws
        if law.gain > PLAIN * above
    ]


def _promised(law: Law) -> float:
    return law.gain


def _peaks(laws: Sequence[Law]) -> list[Law]:
    """Those that promise more than their neighbours in frequency, the best first."""
    gains = np.array([-np.inf, *(law.gain for law in laws), -np.inf])
    higher = (gains[1:-1] > gains[:-2]) & (gains[1:-1] >= gains[2:])
    return sorted((law for law, peak in zip(laws, higher, strict=True) if peak), key=lambda law: -law.gain)
