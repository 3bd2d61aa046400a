"""What the pictures of a diagnosis show: measured, before and after, and what each leaves."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.laws.law import FoundLaw
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.panels import (
    COMMAND_COLOUR,
    MEASURED_COLOUR,
    MODEL_COLOUR,
    RESIDUAL_COLOUR,
    Line,
    Panel,
)
from hydrolek_drake.replay.spans import BEYOND_NOISE
from hydrolek_drake.replay.thinning import thinned
from hydrolek_drake.rollout.rollout import Signals

BEFORE_COLOUR = "#b8c0c8"
AFTER_COLOUR = MODEL_COLOUR


def columns(diagnosis: Diagnosis) -> list[list[Panel]]:
    """Training data on the left, held-out data on the right; the joint with the largest mismatch."""
    train, *others = shown_experiments(diagnosis)
    if not others:
        held = next((e for e in diagnosis.held_out if e.joint == train.joint), train)
        return [_stack(diagnosis, train, "", held_out_spans(held))]
    held = others[0]
    right = (
        _stack(diagnosis, held, "fitted, but for the shaded blocks", held_out_spans(held))
        if partly_fitted(diagnosis, held)
        else _stack(diagnosis, held, "held out", ())
    )
    return [_stack(diagnosis, train, "fitted", ()), right]


def shown_experiments(diagnosis: Diagnosis) -> list[Experiment]:
    """The recordings that are shown, of the joint with the largest mismatch: one fitted and one held out.

    One alone where parts of the same recording are held out.
    """
    assert diagnosis.bench is not None
    joint = diagnosis.locations[0].joint if diagnosis.locations else diagnosis.bench.training[0].joint
    train = next(e for e in diagnosis.bench.training if e.joint == joint)
    held = next((e for e in diagnosis.held_out if e.joint == joint), train)
    same = np.array_equal(train.channels[0].measured, held.channels[0].measured, equal_nan=True)
    return [train] if same else [train, held]


def partly_fitted(diagnosis: Diagnosis, held: Experiment) -> bool:
    """Whether other parts of a held-out experiment's recording were fitted."""
    assert diagnosis.bench is not None
    return any(
        e.joint == held.joint
        and np.array_equal(e.channels[0].measured, held.channels[0].measured, equal_nan=True)
        for e in diagnosis.bench.training
    )


def held_out_spans(experiment: Experiment) -> tuple[tuple[float, float], ...]:
    """Stretches of a recording that are held out [s]."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], experiment.used, [False]]).astype(int)))
    last = experiment.time.size - 1
    return tuple(
        (float(experiment.time[a]), float(experiment.time[min(b, last)]))
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    )


def before(diagnosis: Diagnosis, experiment: Experiment) -> Signals:
    """What the nominal model, refitted, does under the recorded command."""
    return _simulated(diagnosis, diagnosis.baseline.hypothesis, experiment)


def after(diagnosis: Diagnosis, experiment: Experiment) -> Signals:
    """What the best model does under the recorded command, with the law for physics in no list if one was found."""
    return _simulated(diagnosis, diagnosis.best.hypothesis, experiment, diagnosis.law)


def _simulated(
    diagnosis: Diagnosis, hypothesis: Hypothesis, experiment: Experiment, law: FoundLaw | None = None
) -> Signals:
    assert diagnosis.bench is not None
    parameters = diagnosis.bench.parameters(hypothesis.effects)
    if law is None or law.joint != experiment.joint:
        records = parameters.records(parameters.unit(hypothesis.values))
        return experiment.simulate(records, diagnosis.step).signals
    own = law_values(law, [held for held in diagnosis.held_out if held.joint == law.joint], experiment)
    records = parameters.records(parameters.unit(law.parameters))
    return law.signals(experiment, records, diagnosis.step, own)


def law_values(law: FoundLaw, held_out: Sequence[Experiment], experiment: Experiment) -> np.ndarray:
    """The values of a law on one recording: a periodic one has a phase of its own on each that was held out.

    Args:
        law: as it was found.
        held_out: experiments of its joint.
        experiment: one of these, or of the training data.
    """
    place = next((i for i, held in enumerate(held_out) if held is experiment), None)
    return law.values if place is None else law.held_out_values[place]


def _stack(
    diagnosis: Diagnosis, experiment: Experiment, what: str, shaded: tuple[tuple[float, float], ...]
) -> list[Panel]:
    without, enlarged = before(diagnosis, experiment), after(diagnosis, experiment)
    more = bool(diagnosis.best.hypothesis.effects) or diagnosis.law is not None
    name_after = "with the missing physics" if diagnosis.law is None else "with the law found"
    time = experiment.time
    stack: list[Panel] = []
    for channel in experiment.channels:
        factor, unit = display_factor(channel.unit), display_unit(channel.unit)
        old, new = getattr(without, channel.model), getattr(enlarged, channel.model)
        curves = [
            ("measured", channel.measured, MEASURED_COLOUR),
            ("nominal model, refitted", old, BEFORE_COLOUR),
        ]
        if more:
            curves.append((name_after, new, AFTER_COLOUR))
        lines = tuple(Line(name, *thinned(time, factor * v), colour) for name, v, colour in curves)
        stack.append(
            Panel(f"{channel.key} [{unit}]", lines, shaded, None, 2.0, heading=what if not stack else "")
        )
        band = BEYOND_NOISE * factor * channel.noise
        told = [("left before", channel.measured - old, RESIDUAL_COLOUR)]
        if more:
            told.append(("left after", channel.measured - new, AFTER_COLOUR))
        for name, residual, colour in told:
            line = Line(name, *thinned(time, factor * residual), colour)
            stack.append(Panel(f"{name} [{unit}]", (line,), shaded, band, 1.0, 2.0 * band))
    command = Line(
        "command", *thinned(experiment.command_times, experiment.command), COMMAND_COLOUR, stepped=True
    )
    stack.append(Panel("command [V]", (command,), shaded, None, 0.8))
    return stack
