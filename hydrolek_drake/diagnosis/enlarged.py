"""The rig with what was found: fitted values, effects switched on, and the law for physics in no list."""

from dataclasses import replace

from hydrolek_drake.diagnosis.law_growing import LONGEST
from hydrolek_drake.diagnosis.law_problem import FoundLaw, records_of
from hydrolek_drake.diagnosis.workbench import Hypothesis
from hydrolek_drake.physics.law import MOST_TERMS
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.short_law import terms_of

SOURCE = "fitted to recordings by hydrolek diagnose"


def enlarged_rig(rig: Rig, hypothesis: Hypothesis, law: FoundLaw | None) -> Rig:
    """A rig with a hypothesis's values and a law, each with its source.

    Args:
        rig: that was diagnosed.
        hypothesis: named.
        law: found beside it, with which its values were fitted again; None if there is none.
    """
    values = {**hypothesis.values, **(law.parameters if law is not None else {})}
    enlarged = rig.with_values(values)
    entries = dict(enlarged.entries)
    for path in values:
        full = enlarged.full_path(path)
        entries[full] = replace(entries[full], source=SOURCE)
    enlarged = replace(enlarged, entries=entries)
    if law is None or not law.of_the_machine:
        return enlarged
    rows = records_of(law.law, law.span, law.values)
    source = f"{SOURCE}; its phase is the first recording's" if law.law.periodic else SOURCE
    units = (law.law.input.unit, law.span.at(law.law.input.probe).unit)
    terms = terms_of(rows, units, source, "reach of these recordings")
    return replace(enlarged, laws={**rig.laws, law.joint: (*rig.laws.get(law.joint, ()), *terms)})


def room_for_law(rig: Rig, joint: str) -> bool:
    """Whether a rig, which may have a law already, can hold another one at a joint."""
    return len(rig.laws.get(joint, ())) + LONGEST <= MOST_TERMS
