"""Which laws are tried, which of the first fits go on, and which stand in place of effects."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis import law_scan, search, unlisted
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.law_naming import helping
from hydrolek_drake.diagnosis.law_problem import Law
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import Term
from hydrolek_drake.diagnosis.search import outdoes
from hydrolek_drake.diagnosis.unlisted import FITTED, TRIED, Asked, best_of, followed, worth_trying
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")

CONSTANT, GROWING = Term(()), Term((), time="t/T")


def _law(probe: str, term: Term | None, gain: float = 1.0) -> Law:
    terms = () if term is None else (term,)
    return Law(Input("valve", probe, "", "1", 1.0), terms, 0.0 if terms else 1.7, gain, (0.1,))


def _begun(*fits: tuple[str, float]):
    return [(_law(probe, CONSTANT), (left, {}, np.zeros(1))) for probe, left in fits]


def test_a_constant_is_tried_where_an_input_says_how_the_machine_is_built() -> None:
    louder = [_law("supply", GROWING, 90.0 - n) for n in range(2 * TRIED)]
    quiet = [_law("back_a", GROWING, 9.0), _law("back_a", CONSTANT, 2.0), _law("supply", CONSTANT, 1.0)]
    tried = worth_trying([*louder, *quiet])
    assert len(tried) == TRIED
    assert [law.input.probe for law in tried[:3]] == ["supply", "back_a", "back_a"]
    assert tried[2].terms == (CONSTANT,)
    assert quiet[2] not in tried


@pytest.mark.long("takes a quarter of a minute")
def test_both_frequencies_are_told_that_the_beginning_and_the_whole_speak_for(
    bench, recorded, monkeypatch
) -> None:
    """Later on, a model that has made up for a disturbance may be wrong by more, and at another frequency."""
    monkeypatch.setattr(law_scan, "SCAN_S", 6.0)
    monkeypatch.setattr(law_scan, "HIGHEST_HZ", 4.0)  # a matter of time
    [plain] = recorded(bench, bench)
    reading = plain.channels[0]
    early, later = (np.sin(2.0 * np.pi * hz * plain.time) for hz in (1.3, 2.9))
    shaken = reading.measured + reading.noise * np.where(plain.time < 6.0, 3.0 * early + later, 10.0 * later)
    training = [replace(plain, channels=(replace(reading, measured=shaken), *plain.channels[1:]))]
    with ThreadPoolExecutor(2) as pool:
        workbench = Workbench(bench, free_parameters(bench), training, pool)
        asked = Asked.of(workbench, fit_baseline(workbench), [], natural_scales(bench, "joint", training))
        sensor = [given for given in asked.inputs if given.probe == "sensor"]
        laws = promising(workbench, asked.left, sensor, asked.span, asked.step, ())
    assert [law.frequency for law in laws if not law.pulled] == pytest.approx([2.9, 1.3], abs=0.5 / 6.0)


def test_one_law_of_every_input_goes_on_where_first_fits_are_not_told_apart() -> None:
    best = _begun(*[("load", 1000.0 + n) for n in range(FITTED)])
    rest = _begun(("load", 1090.0), ("back_a", 1095.0), ("back_a", 1096.0), ("valve", 1105.0))
    assert followed([*best, *rest]) == [*best, rest[1]]
    assert followed(best[:2]) == best[:2]


@pytest.mark.parametrize(
    ("left", "fitted", "ahead", "is_one"),
    [
        (24.0, 21.0, 1.8, False),  # of 4.4: it helps the held-out data alone
        (24.0, 19.0, 1.8, True),
        (1.2, 1.0, 1.8, True),  # little was left of the training data, and is explained
        (24.0, 19.0, 3.6, False),
    ],
)
def test_a_law_must_help_both_recordings(monkeypatch, left, fitted, ahead, is_one) -> None:
    law = _law("amplifier", GROWING)
    found = SimpleNamespace(
        law=law, fit=SimpleNamespace(over_noise=fitted, counted=1000, unit=np.zeros(9), objective=1.0),
        held_out_over_noise=ahead, rivals=(),
    )  # fmt: skip
    monkeypatch.setattr(unlisted, "glance", lambda *_: (1.0, {}, np.zeros(1)))
    monkeypatch.setattr(unlisted, "fitted", lambda *_: found)
    monkeypatch.setattr(unlisted, "grown", lambda bench, left, law, *_: law)
    monkeypatch.setattr(unlisted, "_other_side", lambda *_: [])
    monkeypatch.setattr(unlisted, "likeliest", lambda alike, *_: alike[0])
    monkeypatch.setattr(unlisted, "_finished", lambda bench, left, law, *_: law)
    bench = SimpleNamespace(fine=1e-3, side_by_side=lambda work, items: [work(item) for item in items])
    nominal = SimpleNamespace(fit=SimpleNamespace(over_noise=left))
    asked = Asked(nominal, (), (), None, 1e-3)
    assert (best_of(bench, asked, [law], 0.8 * 4.4) is found) == is_one


@pytest.mark.parametrize(
    ("without", "before", "after", "helps"),
    [
        (
            0.99,
            3901.0,
            3899.7,
            False,
        ),  # the model explains the training data, and the law gains what chance does
        (0.99, 3901.0, 3860.0, True),
        (1.6, 9000.0, 3899.7, True),
    ],
)
def test_where_the_training_data_are_explained_a_law_must_gain_there_what_chance_does_not(
    without, before, after, helps
) -> None:
    law = SimpleNamespace(fit=SimpleNamespace(over_noise=0.98, objective=after))
    left = SimpleNamespace(fit=SimpleNamespace(over_noise=without))
    refitted = SimpleNamespace(fit=SimpleNamespace(objective=before, counted=4000, unsure=0.0))
    bench = SimpleNamespace(refit=lambda *_, **__: refitted)
    assert helping(bench, left, [law], 1e-3) == ([law] if helps else [])


def _with_effects(count, over_noise):
    fit = Fit(
        np.zeros(1), np.full(1000, over_noise), np.zeros(1), np.zeros((1000, 1)), np.zeros((1, 1)), 1000, 1
    )
    return Hypothesis(tuple(SimpleNamespace(size_path=str(n), free=()) for n in range(count)), {}, fit, 1e-3)


@pytest.mark.parametrize(
    ("law", "effects", "left", "better"),
    [
        (0.96, 1, 0.93, False),  # a small effect, and a sine that makes up for a part of it
        (1.00, 1, 1.001, False),  # no more than chance brings
        (1.00, 1, 1.20, True),  # a pump's ripple, and what comes nearest of the list
        (1.00, 2, 1.01, True),  # one thing for two
        (1.00, 3, 1.00, True),  # one thing for three
        (1.30, 2, 1.00, False),
    ],
)
def test_a_law_in_place_of_effects_must_outdo_them(law, effects, left, better) -> None:
    found = SimpleNamespace(fit=SimpleNamespace(over_noise=law))
    assert outdoes(found, _with_effects(effects, left)) is better


@pytest.mark.parametrize(
    ("law_at", "two_leave", "most_rounds", "asked", "told"),
    [
        (1, 1.5, 2, ["law"], "law"),  # a law of the machine ends the search
        (2, 1.5, 3, ["law", "law"], "law"),
        # what is the recordings' own waits until two effects have been tried, and is not asked where they do, ...
        (None, 1.0, 2, ["law"], None),
        (None, 1.5, 2, ["law", "lost"], "lost"),
        (None, 1.5, 3, ["law", "law", "lost"], "lost"),
        # ... or until no second one promises anything
        (None, 1.5, 1, ["law", "lost"], "lost"),
    ],
)
def test_two_effects_are_tried_before_what_is_the_recordings_own(
    monkeypatch, law_at, two_leave, most_rounds, asked, told
) -> None:
    found, questions = Search(), []
    found.keep(_with_effects(0, 2.0))
    left_by = {1: 1.5, 2: two_leave, 3: two_leave}

    def grown(bench, found, beam, candidates, say):
        found.rounds += 1
        found.keep(_with_effects(found.rounds, left_by[found.rounds]))
        return candidates, beam

    class Other:
        def __call__(self, nominal, effects):
            questions.append("law")
            return self._law("law") if effects == law_at else None

        def lost(self, nominal):
            questions.append("lost")
            return self._law("lost")

        def _law(self, what):
            return SimpleNamespace(fit=_with_effects(0, 1.03).fit, what=what)

    monkeypatch.setattr(search, "_grown", grown)
    monkeypatch.setattr(search, "exchanged", lambda *given: [])
    monkeypatch.setattr(search, "_worth_going_on", lambda found, material: found.rounds < max(most_rounds, 1))
    search._go_on(SimpleNamespace(alike=1.0), [], found, [found.best], lambda text: None, Other())
    assert questions == asked
    assert (None if found.law is None else found.law.what) == told


@pytest.mark.parametrize(("falls_to", "asked"), [(1.2, ["grown", "grown", "law"]), (2.0, ["grown", "law"])])
def test_effects_are_tried_where_they_led_the_nominal_model_before_a_law_is(
    monkeypatch, falls_to, asked
) -> None:
    """Once: what led it there may have had the wrong size, and the right one promises nothing where it was stuck."""
    found, done = Search(), []
    found.keep(_with_effects(0, 2.0))

    def grown(bench, found, beam, candidates, say):
        done.append("grown")
        found.rounds += 1
        found.extended.update({h.ids: h.fit.objective for h in beam})
        found.keep(_with_effects(0, falls_to - 0.05 * len(done)))
        return candidates, [found.best]

    def explained(other, found, material):
        done.append("law")
        return SimpleNamespace(fit=_with_effects(0, 1.03).fit)

    monkeypatch.setattr(search, "_grown", grown)
    monkeypatch.setattr(search, "_explained_otherwise", explained)
    monkeypatch.setattr(search, "_worth_going_on", lambda found, material: True)
    monkeypatch.setattr(search, "gain_needed", lambda fit: 300.0)  # a model at 2.0 leaves 4000 squares
    search._go_on(SimpleNamespace(alike=1.0), [], found, [found.best], lambda text: None, object())
    assert done == asked
    assert found.rounds == 1


@pytest.mark.parametrize(("effects", "beside"), [(0, 1.2), (1, 2.0)])
def test_scores_of_effects_are_those_beside_the_nominal_model_where_it_was_led(
    monkeypatch, effects, beside
) -> None:
    found = Search(scores=[2.0])
    found.keep(_with_effects(0, 2.0))
    more = SimpleNamespace(hypotheses=[_with_effects(effects, 1.2)], given_up={})
    monkeypatch.setattr(search, "grow", lambda *given: more)
    monkeypatch.setattr(search, "searched_further", lambda bench, found, candidates, say: candidates)
    for name in ("prune", "weigh_anew", "widen", "lead_on", "widen_where_promised"):
        monkeypatch.setattr(search, name, lambda *given: None)
    monkeypatch.setattr(search, "scores_of", lambda bench, best, *given: [best.fit.over_noise])
    bench = SimpleNamespace(fine=1e-3, together=False)
    search._grown(bench, found, [found.baseline], [], lambda text: None)
    assert found.left == pytest.approx([1.2])
    assert found.scores == pytest.approx([beside])
