"""What is told of physics in no list: the law that a structure's terms are together, or commands that got lost."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.evidence.nuisance import with_stands
from hydrolek_drake.diagnosis.intervals.curvature import intervals_of
from hydrolek_drake.diagnosis.laws.law import FRICTIONS, FoundLaw, Law
from hydrolek_drake.diagnosis.settings import DROPOUTS, LOCATING, NOISE
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.inputs import SIDES, Input
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.diagnosis.structures.lost_windows import (
    LostWindows,
    Windows,
    arrivals,
    joined,
    lost_in,
    recording_of,
)
from hydrolek_drake.diagnosis.structures.term_forms import Term
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.physics.law import PLACED
from hydrolek_drake.rollout.rollout import Signals


def terms_of(hypothesis: Hypothesis) -> list[LawTerm]:
    """The terms of laws of a structure."""
    return [c for c in hypothesis.effects if isinstance(c, LawTerm)]


def law_of(
    bench: Workbench, judged: Judged, held_out: Sequence[Experiment], rivals: Sequence[str]
) -> FoundLaw:
    """What a structure's terms are together.

    Args:
        bench: data and problems.
        judged: a structure with terms.
        held_out: data that it was held against.
        rivals: other stages at which a law does as well.
    """
    h = bench.without_jumps(judged.hypothesis)
    terms = terms_of(h)
    first = terms[0]
    periodic = first.term is None
    forms = tuple(_as_fitted(t, h) for t in terms if t.term is not None)
    law = Law(first.input, () if periodic else forms, first.frequency if periodic else 0.0)
    paths = list(h.values)
    order = [paths.index(t.size_path) for t in terms]
    if periodic:
        order += [paths.index(f"{first.path}.{name}") for name in ("cosine", "frequency")]
    else:
        order += [
            paths.index(f"{t.path}.{name}")
            for t in terms
            if t.term is not None
            for name in PLACED.get(t.term.place, ())
        ]
    rest = [i for i in range(len(paths)) if i not in order]
    parameters = bench.parameters(h.effects)
    held_out_values = []
    stands = with_stands(bench, judged, held_out).stands
    for effects, unit in (stands[recording_of(experiment)] for experiment in held_out):
        values = bench.parameters(effects).values(unit)
        held_out_values.append(np.array([values[paths[i]] for i in order]))
    experiment = next(e for e in bench.training if e.joint == first.joint)
    records = parameters.records(h.fit.unit)
    without = records.copy()
    without["law"] = bench.rig.records()["law"]
    with_law, plain = (
        experiment.simulate(r, bench.step_for(h.effects)).signals.reading for r in (records, without)
    )
    return FoundLaw(
        law=law,
        values=np.array([h.values[paths[i]] for i in order]),
        parameters={paths[i]: h.values[paths[i]] for i in rest},
        fit=_told(h, terms, order, rest),
        held_out_over_noise=judged.over_noise,
        difference=with_law - plain,
        span=first.span,
        held_out_values=tuple(
            own for own, e in zip(held_out_values, held_out, strict=True) if e.joint == first.joint
        ),
        joint=first.joint,
        rivals=tuple(rivals),
        intervals={
            path: known for path, known in intervals_of(parameters, h.fit).items() if ".law." not in path
        },
    )


def _as_fitted(term: LawTerm, h: Hypothesis) -> Term:
    """The form of a term, where it was fitted."""
    assert term.term is not None
    own = PLACED.get(term.term.place, ())
    centre = h.values[f"{term.path}.centre"] if "centre" in own else term.term.centre
    reach = h.values[f"{term.path}.reach"] if "reach" in own else term.term.reach
    return replace(term.term, centre=centre, reach=reach)


def _told(h: Hypothesis, terms: Sequence[LawTerm], order: list[int], rest: list[int]) -> Fit:
    """The fit with the terms' parameters last, on the scales that `laws.law` takes them in."""
    scales = np.ones(len(h.fit.unit))
    for term in terms:
        paths = list(h.values)
        if term.input.one_sided:
            scales[paths.index(term.size_path)] = 2.0
        if term.term is None:
            scales[paths.index(f"{term.path}.frequency")] = 1.0 / (LOCATING.scan_s * 2.0 * term.breadth)
    turned = [*rest, *order]
    slopes = h.fit.jacobian * scales
    return replace(
        h.fit,
        unit=h.fit.unit[turned],
        off_prior=h.fit.off_prior[turned],
        slopes=slopes[:, turned],
        prior_jacobian=h.fit.prior_jacobian[np.ix_(turned, turned)],
    )


def likeliest_side(judged: Sequence[Judged]) -> Judged:
    """The most probable structure; of laws at the rod and at the joint that do hardly differ, the likelier side.

    A friction at the rod and one at the joint make the same movement and pressures if each may vary over the stroke,
    and so do any two forces where the lever is constant. A friction is named at the rod then, where seals are pressed
    on by the oil, and what pushes or shakes at the load: an assumption about such machines; the other side is told too.

    Args:
        judged: structures, the most probable first.
    """
    best = judged[0]
    stage, brakes = _side(best)
    if stage not in SIDES:
        return best
    wanted = "cylinder" if brakes else "load"
    most = _left(best) * NOISE.above
    near = (j for j in judged if _side(j) == (wanted, brakes) and _left(j) <= most)
    return next(near, best)


def _side(judged: Judged) -> tuple[str, bool]:
    """The stage of a structure's law, and whether it is a friction."""
    terms = terms_of(judged.hypothesis)
    brakes = all(t.term is not None and t.term.speed in FRICTIONS for t in terms)
    return (terms[0].input.stage, brakes) if terms else ("", False)


def _left(judged: Judged) -> float:
    """Squares that a structure leaves of all data."""
    return judged.hypothesis.fit.objective + float(judged.held_out @ judged.held_out)


LOST = Input(
    "command", "command", "time for which a command is lost", "s", DROPOUTS.longest_s, one_sided=True
)
"""What is told of them: how long one lasts."""


@dataclass(frozen=True)
class LostCommands(FoundLaw):
    """Commands that got lost, fitted.

    Attributes:
        windows: recording (`windows.recording_of`) -> when.
        called: recording -> its name.
        neutral: command that acts meanwhile [V].
    """

    windows: Mapping[str, Windows] = field(default_factory=dict)
    called: Mapping[str, str] = field(default_factory=dict)
    neutral: float = 0.0

    of_the_machine: ClassVar[bool] = False
    remark: ClassVar[str] = (
        "This is the recordings' own: the fitted rig runs as if every command had arrived."
    )

    @property
    def condition(self) -> str:
        """When it acts."""
        return "while commands are lost"

    @property
    def acts(self) -> tuple[tuple[float, float], ...]:
        """When commands were lost in the first training recording [s]."""
        return tuple((begin, end) for begin, end in next(iter(self.windows.values())).tolist())

    def more(self) -> dict[str, Any]:
        """When commands were lost in each recording [s]."""
        return {"windows_s": {self.called[which]: lost.tolist() for which, lost in self.windows.items()}}

    def equation(self) -> str:
        """What was lost, and when."""
        lasted = np.concatenate([np.diff(lost, axis=1).ravel() for lost in self.windows.values()])
        when = "; ".join(
            f"in {self.called[which]} at {', '.join(f'{begin:.2f}' for begin in lost[:, 0])} s"
            for which, lost in self.windows.items()
            if len(lost)
        )
        return f"a command that is lost for {lasted.min():.3g} to {lasted.max():.3g} s at a time ({when})"

    def signals(
        self, experiment: Experiment, records: np.ndarray, step: float, values: np.ndarray
    ) -> Signals:
        """What the machine does under the commands that arrived."""
        arrived = experiment.without_command(self.windows[recording_of(experiment)], self.neutral)
        return arrived.simulate(records, step).signals


def lost_of(bench: Workbench, judged: Judged, held_out: Sequence[Experiment]) -> LostCommands:
    """What is told of the commands that a structure has lost.

    Args:
        bench: data and problems.
        judged: a structure with lost commands.
        held_out: data that it was held against.
    """
    h = bench.without_jumps(judged.hypothesis)
    lost = lost_in(h.effects)
    assert lost is not None
    every = {recording: joined(windows) for recording, windows in lost.windows(h.values).items()}
    for effects, unit in with_stands(bench, judged, held_out).stands.values():
        windows_now = next(c for c in effects if isinstance(c, LostWindows))
        own = windows_now.windows(bench.parameters(effects).values(unit))
        every |= {recording: joined(windows) for recording, windows in own.items()}
    parameters = bench.parameters(h.effects)
    records = parameters.records(h.fit.unit)
    first = next(e for e in bench.training if e.joint == lost.joint)
    [arrived] = arrivals(h.effects, h.values, [first])
    with_lost, plain = (
        e.simulate(records, bench.step_for(h.effects)).signals.reading for e in (arrived, first)
    )
    lasted = np.concatenate([np.diff(windows, axis=1).ravel() for windows in every.values()])
    return LostCommands(
        law=Law(LOST, (Term(("command",)),), 0.0),
        values=np.array([float(np.median(lasted))]),
        parameters={path: value for path, value in h.values.items() if ".lost." not in path},
        fit=h.fit,
        held_out_over_noise=judged.over_noise,
        difference=with_lost - plain,
        span=lost.span,
        held_out_values=tuple(every[recording_of(e)].ravel() for e in held_out if e.joint == lost.joint),
        joint=lost.joint,
        intervals={p: known for p, known in intervals_of(parameters, h.fit).items() if ".lost." not in p},
        windows=every,
        called=names_of([*bench.training, *held_out]),
        neutral=lost.neutral,
    )


def names_of(experiments: Sequence[Experiment]) -> dict[str, str]:
    """Recording -> its name, with a number where several have it."""
    names: dict[str, str] = {}
    for experiment in experiments:
        if recording_of(experiment) not in names:
            alike = sum(name.partition(" (")[0] == experiment.name for name in names.values())
            names[recording_of(experiment)] = (
                experiment.name if not alike else f"{experiment.name} ({alike + 1})"
            )
    return names
