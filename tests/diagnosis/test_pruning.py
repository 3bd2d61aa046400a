"""What is found is held against less: without an effect, and with the special case of one."""

import math
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

import pytest

from hydrolek_drake.diagnosis.candidates import candidates_of
from hydrolek_drake.diagnosis.effort import LOOK, NEAR, NEARLY, POLISH
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.improving import exchanged, prune, widen, widen_where_promised
from hydrolek_drake.diagnosis.lessening import SLIGHT, lessened, passed_on, slightly_worse, start_of_lesser
from hydrolek_drake.diagnosis.score import score_in_place, scores_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import Free, free_parameters

COULOMB = 600.0


@contextmanager
def _searched(bench, experiments):
    """A workbench, every candidate, and Stribeck and Coulomb friction among them."""
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
    known = {c.id: c for c in candidates}
    with ThreadPoolExecutor(2) as pool:
        work = Workbench(bench, free_parameters(bench, ["load.gravity_cos"]), experiments, pool)
        yield work, candidates, *(known[f"cylinder.{name}_friction"] for name in ("stribeck", "coulomb"))


def test_coulomb_friction_is_tried_where_stribeck_friction_was_found(bench, recorded) -> None:
    machine = bench.with_values({"effects.cylinder.coulomb_friction.coulomb_N": COULOMB})
    with _searched(bench, recorded(machine, bench)) as (work, candidates, stribeck, coulomb):
        found = Search()
        found.keep(work.fit((stribeck,), stribeck.starts[0], work.fine, POLISH))
        general = found.best
        prune(work, found, candidates)
    special = found.hypotheses[frozenset({coulomb.size_path})]
    assert special.values[coulomb.size_path] == pytest.approx(COULOMB, rel=0.02)
    # two parameters more gain no more than chance
    assert special.fit.objective - general.fit.objective < gain_needed(special.fit)
    assert found.best.ids == special.ids


STRIBECK = {"coulomb_N": 600.0, "stribeck_N": 900.0, "stribeck_velocity_m_per_s": 0.006}


def test_stribeck_friction_is_tried_from_where_coulomb_friction_was_found(bench, recorded) -> None:
    path = "effects.cylinder.stribeck_friction"
    machine = bench.with_values({f"{path}.{name}": value for name, value in STRIBECK.items()})
    with _searched(bench, recorded(machine, bench)) as (work, candidates, stribeck, coulomb):
        found = Search()
        found.keep(work.fit((coulomb,), coulomb.starts[0], work.fine, POLISH))
        special = found.best
        widen(work, found, special, candidates)
    wider = found.hypotheses[frozenset({stribeck.size_path})]
    assert found.best.ids == wider.ids
    assert special.fit.objective - wider.fit.objective > gain_needed(special.fit)
    for name, value in STRIBECK.items():
        assert wider.values[f"{stribeck.path}.{name}"] == pytest.approx(value, rel=0.1)


@pytest.mark.parametrize("stribeck_N", [0.0, 250.0])
def test_near_the_noise_what_contains_an_effect_is_fitted_where_it_promises_something(
    bench, recorded, stribeck_N
) -> None:
    """Coulomb friction explains nearly all; the rest is seen beside it, with the friction that was found."""
    own = {**STRIBECK, "stribeck_N": stribeck_N}
    machine = bench.with_values(
        {f"effects.cylinder.stribeck_friction.{name}": value for name, value in own.items()}
    )
    with _searched(bench, recorded(machine, bench)) as (work, candidates, stribeck, coulomb):
        found = Search()
        found.keep(work.fit((coulomb,), coulomb.starts[0], work.fine, LOOK))
        special = found.best
        score = score_in_place(work, special, coulomb, stribeck, work.fine)
        widen_where_promised(work, found, candidates)
        wider = found.best
        half = math.sqrt(0.5 * (1.0 + special.fit.objective / wider.fit.objective))
        residuals, off = half * wider.fit.residuals, half * wider.fit.off_prior
        stuck = replace(wider, fit=replace(wider.fit, residuals=residuals, off_prior=off))
        again = Search()
        again.keep(special)
        again.keep(stuck)
        assert again.best is stuck or wider is special
        widen_where_promised(work, again, candidates)
    assert again.best.fit.objective == pytest.approx(wider.fit.objective, rel=1e-9)
    assert special.fit.over_noise < NEAR
    assert score.start[f"{stribeck.path}.coulomb_N"] == special.values[coulomb.size_path]
    if stribeck_N == 0.0:
        assert score.gain < gain_needed(special.fit)
        assert found.best is special
    else:
        assert score.gain > gain_needed(special.fit)
        assert special.fit.objective - found.best.fit.objective > gain_needed(special.fit)
        assert found.best.values[f"{stribeck.path}.coulomb_N"] == pytest.approx(600.0, rel=0.1)


def test_a_model_that_ended_elsewhere_is_fitted_from_where_a_wider_one_ended(bench, recorded) -> None:
    machine = bench.with_values({"effects.cylinder.coulomb_friction.coulomb_N": COULOMB})
    with _searched(bench, recorded(machine, bench)) as (work, _, stribeck, coulomb):
        wider = work.fit((stribeck,), stribeck.starts[0], work.fine, POLISH)
        right = work.fit((coulomb,), coulomb.starts[0], work.fine, POLISH)

        def left_behind(share: float, slight: float = SLIGHT) -> list[Hypothesis]:
            scale = math.sqrt((1.0 + share) * wider.fit.objective / right.fit.objective)
            left, off = scale * right.fit.residuals, scale * right.fit.off_prior
            away = {**right.values, coulomb.size_path: 1.3 * COULOMB}
            stuck = replace(right, values=away, fit=replace(right.fit, residuals=left, off_prior=off))
            return slightly_worse(work, [wider], {h.ids: h for h in (wider, stuck)}, slight)

        for share, slight in ((0.5 * SLIGHT, SLIGHT), (4.0 * SLIGHT, SLIGHT), (4.0 * SLIGHT, 0.0)):
            (again,) = left_behind(share, slight)
            assert again.ids == right.ids
            assert again.values[coulomb.size_path] == pytest.approx(COULOMB, rel=0.02)
            assert again.fit.objective - wider.fit.objective < gain_needed(wider.fit)
        assert left_behind(-0.01) == []  # what is better already needs no other start


def test_a_model_that_lacks_an_effect_is_not_fitted_from_where_a_wider_one_ended(bench, recorded) -> None:
    path = "effects.cylinder.stribeck_friction"
    machine = bench.with_values({f"{path}.{name}": value for name, value in STRIBECK.items()})
    with _searched(bench, recorded(machine, bench)) as (work, _, stribeck, coulomb):
        lacking = work.fit((coulomb,), coulomb.starts[0], work.fine, POLISH)
        wider = work.fit((stribeck,), stribeck.starts[0], work.fine, POLISH)
        assert lacking.fit.objective > (1.0 + SLIGHT) * wider.fit.objective
        assert slightly_worse(work, [wider], {h.ids: h for h in (wider, lacking)}) == []


DELAY, OWN_DELAY = 0.08, "joints.joint.command.delay"


def test_a_delay_that_the_machine_s_own_may_take_over_is_no_missing_physics(bench, recorded) -> None:
    """As on the arms, whose rig knows the delay only roughly: a fit that got stuck without the effect goes on."""
    machine = bench.with_values({"effects.command.delay.delay_s": DELAY})
    experiments = recorded(machine, bench)
    delay = next(
        c
        for c in candidates_of(bench, "joint", natural_scales(bench, "joint", experiments))
        if c.id == "command.delay"
    )
    own = bench.value(OWN_DELAY)
    with ThreadPoolExecutor(2) as pool:
        for upper, taken in ((0.4, True), (own + 0.5 * DELAY, False)):
            work = Workbench(bench, [Free(OWN_DELAY, 0.5 * own, upper, True)], experiments, pool)
            with_effect = work.fit((delay,), {delay.size_path: DELAY, OWN_DELAY: own}, work.fine, POLISH)
            start = passed_on(work.nominal, delay, with_effect.values)
            total = with_effect.values[OWN_DELAY] + with_effect.values[delay.size_path]
            assert start[OWN_DELAY] == pytest.approx(total if taken else with_effect.values[OWN_DELAY])
            (without,) = lessened(work, with_effect, [delay])
            worse = without.fit.objective - with_effect.fit.objective
            assert (worse < gain_needed(with_effect.fit)) is taken


def test_a_shifted_null_is_passed_on_to_both_overlaps_or_none(bench, recorded) -> None:
    candidates = candidates_of(bench, "joint", natural_scales(bench, "joint", recorded(bench, bench)))
    shift = next(c for c in candidates if c.id == "valve.asymmetric_overlap")
    own = [Free(f"joints.joint.valve.overlap_{side}", 1e-5, 9e-5, True) for side in "ab"]
    values = {own[0].path: 6e-5, own[1].path: 6e-5, shift.size_path: 2e-5}
    assert passed_on(own, shift, values) == pytest.approx({**values, own[0].path: 8e-5, own[1].path: 4e-5})
    assert (
        passed_on(own[:1], shift, {k: v for k, v in values.items() if k != own[1].path})[own[0].path] == 6e-5
    )


def test_what_a_hypothesis_contains(bench, recorded) -> None:
    with _searched(bench, recorded(bench, bench)) as (work, candidates, stribeck, coulomb):
        bow = next(c for c in candidates if c.id == "sensor.nonlinearity")
        both = work.fit((stribeck, bow), {**stribeck.starts[0], **bow.starts[0]}, work.fine, 1)
        nominal, special, other = (work.fit(e, {}, work.fine, 1) for e in ((), (coulomb, bow), (coulomb,)))
    own = work.nominal
    assert start_of_lesser(both, nominal, own) == both.values
    start = start_of_lesser(both, special, own)
    assert start is not None
    assert start[coulomb.size_path] == both.values[f"{stribeck.path}.coulomb_N"]
    assert start_of_lesser(both, other, own) is not None
    assert start_of_lesser(both, both, own) is None
    assert start_of_lesser(nominal, both, own) is None
    assert start_of_lesser(other, special, own) is None


def test_where_no_effect_may_be_added_one_that_does_little_gives_way(bench, recorded) -> None:
    """Droop, piston leakage and seal friction; the best model so far has warming oil in the place of the droop."""
    concealed = {
        "supply.pressure_droop.resistance_Pa_s_per_m3": 6e10,
        "cylinder.cross_port_leakage.conductance_m3_per_s_Pa": 1.5e-12,
        "cylinder.coulomb_friction.coulomb_N": COULOMB,
    }
    machine = bench.with_values({f"effects.{path}": value for path, value in concealed.items()})
    with _searched(bench, recorded(machine, bench)) as (work, candidates, _, coulomb):
        known = {c.id: c for c in candidates}
        leak, droop, warm = (
            known[name] for name in ("cylinder.cross_port_leakage", "supply.pressure_droop", "fluid.warm_up")
        )
        effects = (coulomb, leak, warm)
        right = {c.size_path: concealed[c.size_path.split(".effects.")[1]] for c in (coulomb, leak)}
        found = Search()
        found.keep(work.fit(effects, {**warm.starts[0], **right}, work.fine, POLISH))
        before = found.best
        assert before.fit.over_noise > NEARLY
        found.left = scores_of(work, before, candidates, work.fine)
        exchanged(work, found, candidates)
    assert found.best.ids == frozenset(c.size_path for c in (coulomb, leak, droop))
    assert found.best.fit.over_noise < 1.1
    assert found.best.values[droop.size_path] == pytest.approx(6e10, rel=0.05)
