"""What a search and its judgement gave."""

from dataclasses import dataclass

from hydrolek_drake.diagnosis.evidence.conclusion import Conclusion
from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.laws.law import FoundLaw
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate
from hydrolek_drake.diagnosis.search.tried import Tried
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment

INTERRUPTED = "interrupted: this is what was known by then; run it again for the whole answer"

BY_BOTH = (
    "the model that explains the training data best fails on the held-out data, and another fit explains both: two "
    "thirds of the held-out data were fitted too, and the rest was held out"
)


@dataclass(frozen=True)
class Known:
    """What one search and its judgement gave.

    Attributes:
        bench: data and problems.
        found: all that was tried.
        held_out: data that nothing was fitted to, weighted by the best structure.
        judged: structures held against them, the most probable first.
        conclusion: what both say.
        interrupted: whether the search was ended by the user.
    """

    bench: Workbench
    found: Tried
    held_out: tuple[Experiment, ...]
    judged: tuple[Judged, ...]
    conclusion: Conclusion
    interrupted: bool


@dataclass(frozen=True)
class Answer:
    """What is told.

    Attributes:
        known: the search that counts, and its judgement.
        conclusion: what the data say.
        law: for physics in no list, the law found for it, if one was.
        remarks: how it came about, for the report.
        estimates: courses of unknown inputs around the nominal model, the likeliest first, where they were asked for.
    """

    known: Known
    conclusion: Conclusion
    law: FoundLaw | None = None
    remarks: tuple[str, ...] = ()
    estimates: tuple[Estimate, ...] = ()
