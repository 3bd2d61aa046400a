"""Where and when a law acts."""

from hydrolek_drake.diagnosis.laws.law import FoundLaw
from hydrolek_drake.diagnosis.locating.place import (
    Location,
    conditions_for,
    growing_spans,
    left_at,
    share_of,
    told_condition,
)
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def locate_law(bench: Workbench, best: Hypothesis, baseline: Hypothesis, law: FoundLaw) -> Location:
    """Where physics in no list acts: the stage of its law, and when the law makes a difference."""
    experiment = next(e for e in bench.training if e.joint == law.joint)
    signals = experiment.simulate(
        bench.parameters(()).records(bench.parameters(()).unit(law.parameters))
    ).signals
    holds = conditions_for(bench.rig, experiment, signals)
    before, _ = left_at(law.joint, best.fit.residuals, bench.training)
    parts = [law.condition, "" if law.acts else told_condition(experiment.time, law.difference, holds)]
    return Location(
        stage=law.law.input.stage,
        joint=experiment.joint,
        share=share_of(baseline.fit, before - law.fit.chi_squared),
        when=law.acts or growing_spans(experiment.time, law.difference, experiment.channels[0].noise),
        condition="; ".join(part for part in parts if part),
    )
