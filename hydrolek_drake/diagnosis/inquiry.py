"""What is asked one after the other until the data are explained: known effects, more data, a law, other weights."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from hydrolek_drake.diagnosis.again import (
    balanced,
    by_both,
    by_both_as_found,
    by_more_data,
    by_own_numbers,
    by_their_noise,
    by_what_was_overlooked,
    in_place_of_law,
)
from hydrolek_drake.diagnosis.attempt import Known, asked_for, attempt, law_first, predicting
from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.conclusion import Conclusion
from hydrolek_drake.diagnosis.effort import FAR
from hydrolek_drake.diagnosis.law_by_both import known_by_both, law_by_both
from hydrolek_drake.diagnosis.law_choice import (
    alone,
    material,
    seen_beside,
    with_law,
    with_law_at_a_joint,
)
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.law_told_anew import Told, beside
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate
from hydrolek_drake.diagnosis.other_laws import OtherLaws
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.natural_scales import Scales

INTERRUPTED = "interrupted: this is what was known by then; run it again for the whole answer"

MIXED = (
    "the held-out recording shows something that the training data do not, since a model that follows these does "
    "worse on it: two thirds of that recording were fitted too, and the rest was held out"
)

BY_BOTH = (
    "the model that explains the training data best fails on the held-out data, and another fit explains both: two "
    "thirds of the held-out data were fitted too, and the rest was held out"
)


LAW_BY_BOTH = (
    "the law explains the training data, which do not tell all numbers of the machine that the held-out recording "
    "asks for: two thirds of that recording were fitted too, and the rest was held out"
)


@dataclass(frozen=True)
class Answer:
    """What is known so far.

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


@dataclass(frozen=True)
class Inquiry:
    """What is asked of one set of recordings.

    Attributes:
        candidates: every effect that may be missing.
        scales: natural scales of the driven joints at which there may be a law.
        several: whether several joints were driven.
        apart: whether the held-out data are of another kind, not blocks among the rest.
        say: told what is being done.
    """

    candidates: Sequence[Candidate]
    scales: Mapping[str, Scales]
    apart: bool
    say: Callable[[str], None]
    several: bool = False

    def answer(self, bench: Workbench, held_out: Sequence[Experiment]) -> Answer:
        """Ask one after the other; an interrupt ends it with what is known by then.

        Args:
            bench: data and fits.
            held_out: data that nothing is fitted to.

        Raises:
            KeyboardInterrupt: before the nominal model was fitted.
        """
        other = OtherLaws(bench, held_out, self.scales, self.apart) if self.scales else None
        known = attempt(bench, self.candidates, held_out, self.say, other)
        if known.interrupted and known.found.law is None:
            conclusion = known.conclusion
            if conclusion.verdict == "unlisted_physics":  # not every known effect has been tried
                conclusion = replace(conclusion, verdict="ambiguous")
            return Answer(known, conclusion, None, (INTERRUPTED,))
        answer = Answer(known, known.conclusion)
        questions: tuple[Callable[[Answer], Answer], ...] = (
            self._by_own_numbers,
            self._by_both_as_found,
            self._by_a_law_at_once,
            self._by_effects_elsewhere,
            self._by_what_was_overlooked,
            self._by_more_data,
            self._by_a_law,
            self._by_other_weights,
        )
        if known.found.law is not None:
            law = known.found.law
            remarks = (LAW_BY_BOTH,) if law.parts is not None else ()
            answer = Answer(known, alone(known.conclusion, known.judged, law), law, remarks)
            if known.interrupted:  # while it was judged
                return replace(answer, remarks=(*remarks, INTERRUPTED))
            questions = (self._in_parts_of_both, self._beside_the_others, self._by_effects_elsewhere)
        for question in questions:
            try:
                answer = question(answer)
            except KeyboardInterrupt:
                answer.known.bench.resume()
                return replace(answer, remarks=(*answer.remarks, INTERRUPTED))
        return answer

    def _in_parts_of_both(self, answer: Answer) -> Answer:
        """What else was tried, with the data that a law was fitted to and held against."""
        law = answer.law
        if law is None or law.parts is None:
            return answer
        known = known_by_both(answer.known, law, self.say)
        return Answer(known, alone(known.conclusion, known.judged, law), law, (LAW_BY_BOTH,))

    def _beside_the_others(self, answer: Answer) -> Answer:
        """A law that ended the search, with what several joints do to each other beside it."""
        if answer.law is None or not self.several:
            return answer
        known = answer.known
        return _beside(
            known, Told(answer.law, *beside(known.bench, known.found.baseline, answer.law, known.held_out))
        )

    @property
    def _alone(self) -> Scales | None:
        """Scales of the only joint that was driven, if there may be a law at it."""
        return None if self.several else next(iter(self.scales.values()), None)

    def _by_own_numbers(self, answer: Answer) -> Answer:
        """The effects that were found, fitted from the rig's own numbers where they go astray ahead."""
        if self.several:
            return answer
        other = by_own_numbers(answer.known, self.candidates, self.say)
        return answer if other is None else replace(answer, known=other, conclusion=other.conclusion)

    def _by_both_as_found(self, answer: Answer) -> Answer:
        """The model that explains the training data, if parts of both lead it to where it explains both."""
        if self.several or not self.apart:
            return answer
        other = by_both_as_found(answer.known, self.candidates, self.say)
        return answer if other is None else Answer(other, other.conclusion, None, (BY_BOTH,))

    def _by_a_law_at_once(self, answer: Answer) -> Answer:
        """A law in place of more data, if it explains both recordings."""
        if self.several or not (self.apart and law_first(answer.known)):
            return answer
        with_a_law = self._by_a_law(answer)
        law, best = with_a_law.law, with_a_law.conclusion.best.hypothesis
        if law is None or not asked_for(law, best):
            return answer
        if predicting(law):
            return with_a_law
        if best.effects:
            return answer
        both = law_by_both(answer.known.bench, best, law, answer.known.held_out)
        return answer if both is None else self._in_parts_of_both(replace(with_a_law, law=both))

    def _by_effects_elsewhere(self, answer: Answer) -> Answer:
        """Known effects in place of a law, if from other places they explain both recordings better."""
        if answer.law is None or self.several:
            return answer
        other = in_place_of_law(answer.known, answer.law, self.candidates, self.say)
        return answer if other is None else Answer(other, other.conclusion, None, (BY_BOTH,))

    def _by_what_was_overlooked(self, answer: Answer) -> Answer:
        """An effect that promised nothing, where the held-out data leave more than noise."""
        if answer.law is not None or self.several:
            return answer
        other = by_what_was_overlooked(answer.known, self.candidates, self.say)
        return answer if other is None else replace(answer, known=other, conclusion=other.conclusion)

    def _by_more_data(self, answer: Answer) -> Answer:
        """What only the held-out data show, or decide, unless a law predicts them."""
        if answer.law is not None:
            return answer
        known = answer.known
        second = by_more_data(known, self.candidates, self.say) if self.apart else None
        if second is not None:
            return self._by_own_numbers(Answer(second, second.conclusion, None, (MIXED,)))
        other = by_both(known, self.candidates, self.say)
        return answer if other is None else Answer(other, other.conclusion, None, (BY_BOTH,))

    def _by_a_law(self, answer: Answer) -> Answer:
        """A law for what is in no list, unless there is one."""
        if not self.scales or answer.law is not None:
            return answer
        known = answer.known
        if self._alone is None:
            told = with_law_at_a_joint(
                known.bench, answer.conclusion, known.judged, known.held_out, self.scales, self.say
            )
            return answer if told is None else replace(_beside(known, told), remarks=answer.remarks)
        conclusion, law = with_law(
            known.bench, answer.conclusion, known.judged, known.held_out, self._alone, self.say
        )
        return replace(answer, conclusion=conclusion, law=law)

    def _by_other_weights(self, answer: Answer) -> Answer:
        """Signals that count alike, where nothing comes near the noise."""
        known = answer.known
        far = answer.law is None or answer.law.held_out_over_noise > FAR
        if answer.conclusion.verdict != "unlisted_physics" or not far:
            return answer
        again = balanced(known, self.candidates, self.say)
        if again is None:
            return answer
        alike, remark = again
        told = (*answer.remarks, remark, INTERRUPTED) if alike.interrupted else (*answer.remarks, remark)
        try:
            own = by_their_noise(known, alike, self.candidates, self.say)
        except KeyboardInterrupt:
            known.bench.resume()
            own, told = None, (*told, INTERRUPTED)
        if own is not None and own.conclusion.verdict != "unlisted_physics":
            return Answer(own, own.conclusion, None, answer.remarks)
        return Answer(alike, material(alike.conclusion, alike.judged, alike.held_out), None, told)


def _beside(known: Known, told: Told) -> Answer:
    """A law at one of several joints, with the data that it belongs to."""
    bench = known.bench
    bench.training = told.training
    judged = tuple(j if j.hypothesis.effects else seen_beside(bench, j, told.held_out) for j in known.judged)
    known = replace(known, held_out=told.held_out, judged=judged)
    return Answer(known, alone(known.conclusion, judged, told.law), told.law)
