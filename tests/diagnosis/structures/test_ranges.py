"""A range that proves too narrow is widened, as far as the effect's size can be at all."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.report.words import effect_sentence, quantity
from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.identification.experiments.natural_scales import natural_scales

AIR = "effects.fluid.entrained_air.air_fraction"


@pytest.fixture(scope="module")
def candidates(bench, recorded):
    scales = natural_scales(bench, "joint", recorded(bench, bench))
    return {c.id: c for c in candidates_of(bench, "joint", scales)}


def _ended(candidate, **at):
    """Fitted values in the middle of their ranges, but for some at an end: 0 or 1."""
    return {free.path: free.from_unit(at.get(free.path.rpartition(".")[2], 0.5)) for free in candidate.free}


def test_a_size_is_widened_away_from_where_the_effect_is_off(candidates) -> None:
    air, drift, base = (candidates[id_] for id_ in ("fluid.entrained_air", "sensor.drift", "base.compliance"))
    wide = air.widened(_ended(air, air_fraction=1.0))
    assert wide.size.upper == pytest.approx(FITS.wider * air.size.upper)
    assert wide.size.lower == air.size.lower == 0.0
    assert air.widened(_ended(air)) == air == air.widened(_ended(air, air_fraction=0.0))
    name = drift.effect.size
    for end in (0.0, 1.0):
        wide = drift.widened(_ended(drift, **{name: end}))
        assert wide.size.upper == pytest.approx(FITS.wider * drift.size.upper)
        assert wide.size.lower == pytest.approx(FITS.wider * drift.size.lower)
    assert drift.size.lower < 0.0
    # a base is there the more the softer it is
    wide = base.widened(_ended(base, **{base.effect.size: 0.0}))
    assert wide.size.lower == pytest.approx(base.size.lower / FITS.wider)
    assert wide.size.upper == base.size.upper
    assert base.widened(_ended(base, **{base.effect.size: 1.0})) == base
    others = [free for free in wide.free if free.path != base.size_path]
    assert others == [free for free in base.free if free.path != base.size_path]


def test_what_else_an_effect_has_is_widened_at_either_end(candidates) -> None:
    stribeck, payload = candidates["cylinder.stribeck_friction"], candidates["load.payload"]
    name = "stribeck_velocity_m_per_s"
    fades = next(free for free in stribeck.free if free.path.endswith(name))
    for end, factors in ((0.0, (1.0 / FITS.wider, 1.0)), (1.0, (1.0, FITS.wider))):
        wide = next(f for f in stribeck.widened(_ended(stribeck, **{name: end})).free if f.path == fades.path)
        assert (wide.lower, wide.upper) == pytest.approx((factors[0] * fades.lower, factors[1] * fades.upper))
    assert payload.widened(_ended(payload, time_s=1.0)) == payload  # the recording is no longer than that


def test_what_ends_at_an_end_of_its_range_is_told(bench, candidates) -> None:
    """But for a size, that may be small, and a moment, which lies in the recording."""
    warm, payload = candidates["fluid.warm_up"], candidates["load.payload"]

    def diagnosed(candidate, **at):
        fitted = SimpleNamespace(effects=(candidate,), values=_ended(candidate, **at))
        intervals = {path: Interval(value, value, value) for path, value in fitted.values.items()}
        return SimpleNamespace(
            rig=bench, best=SimpleNamespace(hypothesis=fitted), intervals=intervals, locations=()
        )

    for end in (0.0, 1.0):
        hasty = diagnosed(warm, time_constant_s=end)
        [free] = warm.ended(hasty.best.hypothesis.values)
        assert free.path.endswith("time_constant_s")
        told = effect_sentence(warm, hasty)
        assert f"{quantity(free.lower, 's')} to {quantity(free.upper, 's')}" in told
        assert "something else may act like this effect" in told
    for candidate, at in (
        (warm, {}),
        (warm, {warm.effect.size: 0.0}),
        (payload, {"time_s": 1.0}),
    ):
        usual = diagnosed(candidate, **at)
        assert not candidate.ended(usual.best.hypothesis.values)
        assert "something else" not in effect_sentence(candidate, usual)


def test_a_range_is_not_widened_beyond_what_can_be_or_what_the_rig_states(
    bench, recorded, candidates
) -> None:
    fade = candidates["amplifier.gain_fade"]
    # more than all of the current cannot be lost
    assert fade.widened(_ended(fade, **{fade.effect.size: 1.0})).size.upper == 1.0
    path = bench.full_path(AIR)
    entries = {**bench.entries, path: replace(bench.entries[path], range=(0.0, 0.01))}
    stated = replace(bench, entries=entries)
    scales = natural_scales(bench, "joint", recorded(bench, bench))
    air = next(c for c in candidates_of(stated, "joint", scales) if c.id == "fluid.entrained_air")
    assert air.widened(_ended(air, air_fraction=1.0)) == air
