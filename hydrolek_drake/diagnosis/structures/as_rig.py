"""A fitted structure as a rig that every other command runs: values, effects switched on, and laws."""

from dataclasses import replace

from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.law_terms import LawTerm
from hydrolek_drake.physics.law import MOST_TERMS
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.short_law import terms_of

SOURCE = "fitted to recordings by hydrolek diagnose"


def rig_of(rig: Rig, hypothesis: Hypothesis) -> Rig:
    """A rig with a structure's values, effects and terms of laws.

    Args:
        rig: that is diagnosed.
        hypothesis: a structure, fitted.
    """
    values = {
        path: value
        for path, value in hypothesis.values.items()
        if ".law." not in path and ".lost." not in path
    }
    laws = dict(rig.laws)
    for term in hypothesis.effects:
        if isinstance(term, LawTerm):
            units = (term.input.unit, term.span.at(term.input.probe).unit)
            own = terms_of(term.row(hypothesis.values), units, SOURCE, "reach of these recordings")
            laws[term.joint] = (*laws.get(term.joint, ()), *own)
    return replace(rig.with_values(values), laws=laws)


def room_for_law(rig: Rig, joint: str, terms: int) -> bool:
    """Whether a rig, which may have a law already, can hold another one of so many terms at a joint."""
    return len(rig.laws.get(joint, ())) + terms <= MOST_TERMS
