"""Which laws could explain what a model leaves, from rollouts and linear algebra alone (as in `score`)."""

from collections.abc import Sequence

from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_problem import Law
from hydrolek_drake.diagnosis.law_scan import Scan, shaking
from hydrolek_drake.diagnosis.law_terms import Fitted, terms_scored
from hydrolek_drake.diagnosis.laws import TERMS, Span, Term
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench


def promising(
    bench: Workbench,
    left: Hypothesis,
    inputs: Sequence[Input],
    span: Span,
    step: float,
    terms: Sequence[Term] = TERMS,
) -> list[Law]:
    """Every law with the gain that it promises, and the amplitude at which its fit should begin.

    Args:
        bench: training data and rig.
        left: the model that leaves the mismatch.
        inputs: unknown inputs of the joint.
        span: what the laws' variables are told in.
        step: of the integration [s].
        terms: that are tried; none for periodic laws alone.
    """
    parameters = bench.parameters(left.effects)
    records = parameters.records(parameters.unit(left.values))
    model = Fitted(records, span, step, Across(left.fit), left.fit.off_prior)

    def of_terms(given: Input) -> list[Law]:
        return [
            Law(given, told.terms, 0.0, told.gain, told.starts)
            for told in terms_scored(bench, model, given, terms)
        ]

    found = [law for laws in bench.side_by_side(of_terms, inputs if terms else ()) for law in laws]
    most = max((law.gain for law in found if law.sizes == 1), default=0.0)
    found = [law for law in found if law.sizes == 1 or law.gain > most]  # else one term elsewhere is simpler
    found += Scan(bench, left, inputs, span, step).laws()
    return found + shaking(bench, left, inputs, span, step)
