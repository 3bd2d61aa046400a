"""A law of more terms: a smooth function of one variable is a constant, a slope and a bend of it.

One term after the other is added where it stands already, each held against what the law leaves as a first one is
held against what the model leaves; what it makes needless is left out again (stepwise selection: Efroymson, Multiple
regression analysis, 1960).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.conclusion import EXPLAINED, EXPLAINED_AHEAD
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED
from hydrolek_drake.diagnosis.judged import flatter
from hydrolek_drake.diagnosis.law_fit import fitted
from hydrolek_drake.diagnosis.law_problem import FoundLaw, left_in_all, records_of
from hydrolek_drake.diagnosis.law_terms import Fitted, terms_scored
from hydrolek_drake.diagnosis.laws import TERMS, Term
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

LONGEST = 3
"""So many terms at most: a law is to be short."""

FOLLOWED = 2
"""So many further terms are fitted, those that promise most."""


def explains(law: FoundLaw) -> bool:
    """Whether nothing that matters is left."""
    return law.fit.over_noise <= EXPLAINED and law.held_out_over_noise <= EXPLAINED_AHEAD


def grown(
    bench: Workbench, left: Hypothesis, law: FoundLaw, held_out: Sequence[Experiment], step: float
) -> FoundLaw:
    """A law with as many more terms as it takes to come to the noise, or as help.

    A further term must take more of both data than chance would, and must not make the law predict worse.

    Args:
        bench: training data and rig.
        left: the model that the law is added to.
        law: fitted; a periodic one stays what it is.
        held_out: what decides.
        step: of the integration [s].
    """
    counted = law.fit.counted + sum(experiment.counted for experiment in held_out)

    def told(found: FoundLaw) -> tuple[float, float]:
        """What a law leaves, and by how much two must differ there to be told apart."""
        in_all = left_in_all(found.fit, found.held_out_over_noise, held_out)
        return in_all, GAIN_NEEDED * flatter(in_all, counted, len(found.fit.unit))

    while not law.law.periodic and len(law.law.terms) < LONGEST and told(law)[1] > GAIN_NEEDED:
        least = told(law)[0]
        better = [
            further
            for further in _with_one_more(bench, left, law, held_out, step)
            if sum(told(further)) < least and further.held_out_over_noise < law.held_out_over_noise
        ]
        if not better:
            break
        law = _without_needless(bench, left, min(better, key=told), held_out, step, told)
    return law


def _without_needless(
    bench: Workbench,
    left: Hypothesis,
    law: FoundLaw,
    held_out: Sequence[Experiment],
    step: float,
    told: Callable[[FoundLaw], tuple[float, float]],
) -> FoundLaw:
    """The law without the terms that a later one has made needless: both data do not tell that they are there.

    What the first term imitated, the right one does.
    """
    where, sizes = law.law.at(law.values).terms, law.values[: law.law.sizes]
    for number in range(len(where) - 1):
        kept = [k for k in range(len(where)) if k != number]
        fewer = replace(law.law, terms=tuple(where[k] for k in kept))
        begin = (law.parameters, fewer.begun(sizes[kept]))
        shorter = fitted(bench, left, fewer, held_out, law.span, begin, step)
        if told(shorter)[0] < sum(told(law)):
            return shorter
    return law


def only_difference(term: Term, terms: Sequence[Term]) -> bool:
    """Whether a term is of the pressures' difference, where one of them has a term already: the other will do.

    Args:
        term: that may be added.
        terms: that a law has.
    """
    return term.other == "(p_A - p_B)" and any(has.other in ("p_A", "p_B") for has in terms)


def _with_one_more(
    bench: Workbench, left: Hypothesis, law: FoundLaw, held_out: Sequence[Experiment], step: float
) -> list[FoundLaw]:
    """The law fitted again with each of the terms that promise most beside it."""
    parameters = bench.parameters(left.effects)
    model = Fitted(
        parameters.records(parameters.unit(law.parameters)),
        law.span,
        step,
        Across(law.fit),
        law.fit.off_prior,
        records_of(law.law, law.span, law.values),
    )
    free = [term for term in TERMS if term not in law.law.terms and not only_difference(term, law.law.terms)]
    scored = sorted(terms_scored(bench, model, law.law.input, free), key=lambda told: -told.gain)
    scale = law.law.input.scale
    sizes, where = law.values[: law.law.sizes], law.law.at(law.values).terms
    further = [
        (
            replace(law.law, terms=(*where, *told.terms), gain=told.gain),
            np.append(sizes, scale * np.array(told.starts)),
        )
        for told in scored[:FOLLOWED]
        if told.gain > GAIN_NEEDED and len(where) + len(told.terms) <= LONGEST
    ]
    return [
        fitted(bench, left, more, held_out, law.span, (law.parameters, more.begun(amplitudes)), step)
        for more, amplitudes in further
    ]
