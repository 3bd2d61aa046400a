"""Held-out data: what chooses among structures, and what only reports."""

import numpy as np

from hydrolek_drake.diagnosis.settings import DATA
from hydrolek_drake.diagnosis.structures.splitting import halves, mixed


def test_what_reports_is_nothing_that_chose(bench, recorded) -> None:
    [held_out] = recorded(bench, bench)
    [chosen], [kept] = halves([held_out])
    assert not np.any(chosen.used & kept.used)
    np.testing.assert_array_equal(chosen.used | kept.used, held_out.used)
    assert abs(chosen.counted - kept.counted) <= held_out.counted / DATA.short_blocks


def test_parts_of_a_part_are_cut_by_what_counts(bench, recorded) -> None:
    [whole] = recorded(bench, bench)
    last = whole.split(whole.used & (whole.time > 0.8 * whole.time[-1]))
    [chosen], [kept] = halves([last])
    assert chosen.counted > 0.4 * last.counted and kept.counted > 0.4 * last.counted


def test_where_held_out_data_are_fitted_too_what_reports_had_not_chosen_before(bench, recorded) -> None:
    [held_out] = recorded(bench, bench)
    training, [chosen], [kept] = mixed([], [held_out])
    [fitted] = training
    parts = np.stack([fitted.used, chosen.used, kept.used])
    np.testing.assert_array_equal(parts.sum(axis=0), held_out.used)
    assert abs(fitted.counted - 2 / 3 * held_out.counted) <= held_out.counted / DATA.short_blocks
    [_], [before] = halves([held_out])
    assert np.all(before.used[kept.used])
