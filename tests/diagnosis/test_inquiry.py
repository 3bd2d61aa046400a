"""What is asked one after the other, and what an interrupt leaves."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis import inquiry
from hydrolek_drake.diagnosis.attempt import asked_for
from hydrolek_drake.diagnosis.inquiry import BY_BOTH, INTERRUPTED, LAW_BY_BOTH, MIXED, Inquiry


class _Bench:
    resumed = False

    def resume(self):
        self.resumed = True


def _known(verdict, interrupted=False, law=None):
    best = SimpleNamespace(hypothesis=SimpleNamespace(effects=()))
    conclusion = inquiry.Conclusion(verdict, best, {}, ())
    return inquiry.Known(_Bench(), SimpleNamespace(law=law), (), (), conclusion, interrupted)


@pytest.fixture
def asked(monkeypatch):
    """(answers of the questions, of which one may be an interrupt, whether held-out data are apart) -> answer."""

    def ask(apart=True, law_first=False, explained=False, several=False, shown=True, **answers):
        def answering(name):
            def answer(*_):
                told = answers.get(name)
                if told is KeyboardInterrupt:
                    raise KeyboardInterrupt
                return told(*_) if callable(told) else told

            return answer

        for name in (
            "attempt",
            "by_own_numbers",
            "in_place_of_law",
            "by_what_was_overlooked",
            "by_more_data",
            "by_both",
            "by_both_as_found",
            "balanced",
            "by_their_noise",
            "known_by_both",
            "law_by_both",
        ):
            monkeypatch.setattr(inquiry, name, answering(name))
        monkeypatch.setattr(
            inquiry, "with_law", lambda bench, conclusion, *_: answering("with_law")() or (conclusion, None)
        )
        monkeypatch.setattr(
            inquiry, "law_first", lambda known: law_first and known.conclusion.verdict == "unlisted_physics"
        )
        monkeypatch.setattr(inquiry, "predicting", lambda law: explained)
        monkeypatch.setattr(inquiry, "asked_for", lambda law, model: shown)
        monkeypatch.setattr(inquiry, "material", lambda conclusion, *_: replace(conclusion, groups=(("m",),)))
        inquiring = Inquiry((), {"joint": SimpleNamespace()}, apart, lambda text: None, several)
        return inquiring.answer(_Bench(), ())

    return ask


def test_what_explains_the_data_ends_it(asked):
    known = _known("missing_physics")
    answer = asked(attempt=known)
    assert answer.known is known and answer.remarks == () and answer.law is None


def test_a_law_that_ended_the_search_is_the_answer(asked, monkeypatch):
    law = SimpleNamespace(parts=None)
    known = _known("unlisted_physics", law=law)
    monkeypatch.setattr(
        inquiry, "alone", lambda conclusion, judged, law: replace(conclusion, groups=(("l",),))
    )
    answer = asked(attempt=known, with_law=KeyboardInterrupt, by_more_data=KeyboardInterrupt)
    assert answer.law is law and answer.conclusion.groups == (("l",),)
    assert answer.remarks == ()


def test_an_interrupt_while_other_joints_are_told_anew_keeps_the_law(asked, monkeypatch):
    law = SimpleNamespace(parts=None)
    known = _known("unlisted_physics", law=law)
    known.found.baseline = None
    monkeypatch.setattr(inquiry, "alone", lambda conclusion, judged, law: conclusion)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(inquiry, "beside", interrupted)
    answer = asked(attempt=known, several=True)
    assert answer.law is law and answer.remarks == (INTERRUPTED,)
    assert asked(attempt=known).remarks == ()  # one joint has no others


def test_what_was_tried_before_a_law_is_told_with_the_data_that_the_law_was_fitted_to(asked, monkeypatch):
    law = SimpleNamespace(parts=((), ()))
    first, second = _known("unlisted_physics", law=law), _known("unlisted_physics")
    monkeypatch.setattr(inquiry, "alone", lambda conclusion, judged, law: conclusion)
    answer = asked(attempt=first, known_by_both=second)
    assert answer.known is second and answer.law is law and answer.remarks == (LAW_BY_BOTH,)
    answer = asked(attempt=first, known_by_both=KeyboardInterrupt)
    assert answer.known is first and answer.law is law and answer.remarks == (LAW_BY_BOTH, INTERRUPTED)


def test_a_law_that_goes_astray_ahead_is_fitted_to_parts_of_both_before_a_whole_search_is(asked, monkeypatch):
    first, second, third = (_known(v) for v in ("unlisted_physics", "unlisted_physics", "missing_physics"))
    law, both = (SimpleNamespace(held_out_over_noise=1.1, parts=parts) for parts in (None, ((), ())))
    monkeypatch.setattr(inquiry, "alone", lambda conclusion, judged, law: conclusion)
    how = {"attempt": first, "with_law": (first.conclusion, law), "law_first": True, "explained": False}
    answer = asked(law_by_both=both, known_by_both=second, by_more_data=third, **how)
    assert answer.known is second and answer.law is both and answer.remarks == (LAW_BY_BOTH,)
    assert asked(law_by_both=None, by_more_data=third, **how).known is third


def test_an_interrupt_while_a_law_is_judged_keeps_the_law(asked, monkeypatch):
    law = SimpleNamespace(parts=None)
    monkeypatch.setattr(inquiry, "alone", lambda conclusion, judged, law: conclusion)
    answer = asked(attempt=_known("unlisted_physics", interrupted=True, law=law))
    assert answer.law is law and answer.conclusion.verdict == "unlisted_physics"
    assert answer.remarks == (INTERRUPTED,)


def test_an_interrupted_search_does_not_tell_physics_in_no_list(asked):
    answer = asked(attempt=_known("unlisted_physics", interrupted=True), by_both=KeyboardInterrupt)
    assert answer.conclusion.verdict == "ambiguous" and answer.remarks == (INTERRUPTED,)


def test_parts_of_the_held_out_data_are_fitted_only_where_these_are_a_recording_of_their_own(asked):
    first, second = _known("unlisted_physics"), _known("missing_physics")
    assert asked(attempt=first, by_more_data=second).remarks == (MIXED,)
    assert asked(attempt=first, by_more_data=second, apart=False).known is first
    assert asked(attempt=first, by_both=second, apart=False).remarks == (BY_BOTH,)


def test_what_goes_astray_in_parts_of_both_is_fitted_from_the_rigs_own_numbers(asked):
    first, second, third = (_known(v) for v in ("unlisted_physics", "missing_physics", "missing_physics"))
    led = {id(first): None, id(second): third}
    answer = asked(attempt=first, by_more_data=second, by_own_numbers=lambda known, *_: led[id(known)])
    assert answer.known is third and answer.conclusion is third.conclusion and answer.remarks == (MIXED,)


@pytest.mark.parametrize(
    "question", ["by_what_was_overlooked", "by_more_data", "by_both", "with_law", "balanced"]
)
def test_an_interrupt_keeps_what_is_known_and_asks_nothing_more(asked, question):
    first = _known("unlisted_physics")
    answer = asked(attempt=first, **{question: KeyboardInterrupt})
    assert answer.known is first and answer.remarks == (INTERRUPTED,)
    assert first.bench.resumed


def test_other_weights_count_unless_what_they_lead_to_explains_every_signal(asked):
    first, alike, own = _known("unlisted_physics"), _known("unlisted_physics"), _known("missing_physics")
    answer = asked(attempt=first, balanced=(alike, "weighed"))
    assert answer.known is alike and answer.conclusion.groups == (("m",),) and answer.remarks == ("weighed",)
    answer = asked(attempt=first, balanced=(alike, "weighed"), by_their_noise=own)
    assert answer.known is own and answer.conclusion is own.conclusion and answer.remarks == ()
    answer = asked(attempt=first, balanced=(_known("none", interrupted=True), "weighed"))
    assert answer.remarks == ("weighed", INTERRUPTED)
    answer = asked(attempt=first, balanced=(alike, "weighed"), by_their_noise=KeyboardInterrupt)
    assert answer.known is alike and answer.remarks == ("weighed", INTERRUPTED) and first.bench.resumed


def test_a_law_that_comes_near_the_noise_needs_no_other_weights(asked):
    first = _known("unlisted_physics")
    law = SimpleNamespace(held_out_over_noise=1.1, parts=None)
    answer = asked(attempt=first, with_law=(first.conclusion, law), balanced=KeyboardInterrupt)
    assert answer.law is law and answer.remarks == ()


def test_a_law_that_explains_both_recordings_comes_before_more_data(asked):
    first, second = _known("unlisted_physics"), _known("missing_physics")
    law = SimpleNamespace(held_out_over_noise=1.1, parts=None)
    how = {"attempt": first, "with_law": (first.conclusion, law), "by_more_data": second}
    answer = asked(law_first=True, explained=True, **how)
    assert answer.known is first and answer.law is law and answer.remarks == ()
    assert asked(law_first=True, explained=False, **how).known is second
    assert asked(law_first=True, explained=True, shown=False, **how).known is second
    assert asked(law_first=False, explained=True, **how).known is second
    answer = asked(law_first=True, explained=True, **how | {"with_law": KeyboardInterrupt})
    assert answer.known is first and answer.law is None and answer.remarks == (INTERRUPTED,)


def test_a_model_that_explains_both_once_it_is_fitted_to_them_comes_before_a_law(asked):
    first, second = _known("unlisted_physics"), _known("missing_physics")
    law = SimpleNamespace(held_out_over_noise=1.1, parts=None)
    how = {"attempt": first, "with_law": (first.conclusion, law), "law_first": True, "explained": True}
    answer = asked(by_both_as_found=second, **how)
    assert answer.known is second and answer.remarks == (BY_BOTH,)
    assert asked(by_both_as_found=second, apart=False, **how).known is first
    answer = asked(by_both_as_found=KeyboardInterrupt, **how)
    assert answer.known is first and answer.remarks == (INTERRUPTED,) and first.bench.resumed


@pytest.mark.parametrize(("left", "effects", "needed"), [(0.99, 2, False), (0.9, 2, True), (0.99, 0, True)])
def test_training_data_ask_for_a_law_beside_effects_if_it_takes_what_one_more_must(left, effects, needed):
    fit = SimpleNamespace(objective=1000.0, counted=1000, unsure=0.0)  # GAIN_NEEDED of 12 is more than 0.4 %
    model = SimpleNamespace(fit=fit, effects=(None,) * effects)
    assert asked_for(SimpleNamespace(fit=SimpleNamespace(over_noise=math.sqrt(left))), model) is needed


def test_effects_that_explain_both_recordings_from_elsewhere_come_before_a_law(asked, monkeypatch):
    law = SimpleNamespace(held_out_over_noise=1.1, parts=None)
    monkeypatch.setattr(inquiry, "alone", lambda conclusion, judged, law: conclusion)
    ended, first, second = (
        _known("unlisted_physics", law=law),
        _known("unlisted_physics"),
        _known("missing_physics"),
    )
    at_once = {"attempt": first, "with_law": (first.conclusion, law), "law_first": True, "explained": True}
    assert asked(in_place_of_law=second, attempt=ended).law is None
    for how in ({"attempt": ended}, at_once):
        answer = asked(in_place_of_law=second, **how)
        assert answer.known is second and answer.remarks == (BY_BOTH,)
        answer = asked(in_place_of_law=KeyboardInterrupt, **how)
        assert answer.law is law and answer.remarks == (INTERRUPTED,)


def test_what_was_overlooked_is_the_answer_and_other_questions_go_on_from_it(asked):
    first, second, third = _known("none"), _known("missing_physics"), _known("missing_physics")
    answer = asked(attempt=first, by_what_was_overlooked=second)
    assert answer.known is second and answer.conclusion is second.conclusion and answer.remarks == ()
    answer = asked(attempt=first, by_what_was_overlooked=second, by_both=third)
    assert answer.known is third and answer.remarks == (BY_BOTH,)
