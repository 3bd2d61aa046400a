"""A fitted structure as a rig that every other command runs: values, effects switched on, and laws."""

from dataclasses import replace

from hydrolek_drake.diagnosis.laws.additions import LawTerm
from hydrolek_drake.diagnosis.laws.law import FoundLaw, records_of
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis
from hydrolek_drake.physics.law import MOST_TERMS
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.short_law import terms_of

SOURCE = "fitted to recordings by hydrolek diagnose"
RESOLVED = "what was found opens and closes contacts, which a longer step does not resolve"

STEP = "integration.longest_step"


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


def enlarged_rig(rig: Rig, hypothesis: Hypothesis, law: FoundLaw | None) -> Rig:
    """A rig with a hypothesis's values and a law, each with its source.

    Args:
        rig: that was diagnosed.
        hypothesis: named.
        law: found beside it, with which its values were fitted again; None if there is none.
    """
    values = {**hypothesis.values, **(law.parameters if law is not None else {})}
    share = min((c.step_share for c in hypothesis.effects), default=1.0)
    sources = dict.fromkeys(values, SOURCE)
    if share < 1.0:
        values[STEP], sources[STEP] = share * rig.value(STEP), RESOLVED
    enlarged = rig.with_values(values)
    entries = dict(enlarged.entries)
    for path, source in sources.items():
        full = enlarged.full_path(path)
        entries[full] = replace(entries[full], source=source)
    enlarged = replace(enlarged, entries=entries)
    if law is None or not law.of_the_machine:
        return enlarged
    rows = records_of(law.law, law.span, law.values)
    source = f"{SOURCE}; its phase is the first recording's" if law.law.periodic else SOURCE
    units = (law.law.input.unit, law.span.at(law.law.input.probe).unit)
    terms = terms_of(rows, units, source, "reach of these recordings")
    return replace(enlarged, laws={**rig.laws, law.joint: (*rig.laws.get(law.joint, ()), *terms)})


def room_for_law(rig: Rig, joint: str, terms: int) -> bool:
    """Whether a rig, which may have a law already, can hold another one of so many terms at a joint."""
    return len(rig.laws.get(joint, ())) + terms <= MOST_TERMS
