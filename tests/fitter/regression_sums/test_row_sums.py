"""Sums of products of rows."""

import numpy as np
import pytest

from fitter.regression_sums.row_sums import add_equations


def sums_of(rows, tau, moving, ends):
    blocks, n, k = len(ends) - 1, rows.shape[1], rows.shape[2]
    sums = [np.zeros((blocks, n, *shape)) for shape in ((k, k), (k,), (), (k,), (), ())]
    add_equations(np.array(ends), rows, tau, moving, *sums)
    return sums


def test_they_are_the_matrix_products_of_the_rows_that_count():
    rng = np.random.default_rng(0)
    rows, tau = rng.normal(size=(30, 2, 3)), rng.normal(size=(30, 2))
    moving = rng.random((30, 2)) > 0.3
    gram, moment, power, row, torque, count = sums_of(rows, tau, moving, [0, 12, 30])
    for block, part in enumerate((slice(0, 12), slice(12, 30))):
        for joint in range(2):
            W, t = rows[part, joint][moving[part, joint]], tau[part, joint][moving[part, joint]]
            assert gram[block, joint] == pytest.approx(np.tril(W.T @ W))
            assert moment[block, joint] == pytest.approx(W.T @ t)
            assert row[block, joint] == pytest.approx(W.sum(axis=0))
            assert (power[block, joint], torque[block, joint]) == pytest.approx((t @ t, t.sum()))
            assert count[block, joint] == len(t)


def test_blocks_add_up_to_the_whole_in_any_cut():
    rng = np.random.default_rng(1)
    rows, tau, moving = rng.normal(size=(20, 1, 2)), rng.normal(size=(20, 1)), np.ones((20, 1), dtype=bool)
    whole, cut = (sums_of(rows, tau, moving, ends) for ends in ([0, 20], [0, 3, 11, 20]))
    for one, several in zip(whole, cut, strict=True):
        assert several.sum(axis=0) == pytest.approx(one.sum(axis=0))
