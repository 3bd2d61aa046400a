"""The rig with what a diagnosis named and the law that it found beside it, as every other command runs it."""

from dataclasses import replace

from hydrolek_drake.diagnosis.laws.law import FoundLaw, records_of
from hydrolek_drake.diagnosis.structures.as_rig import SOURCE
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.short_law import terms_of

RESOLVED = "what was found opens and closes contacts, which a longer step does not resolve"

STEP = "integration.longest_step"


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
