"""A pass in coarser steps: means of readings, sums of jolts, and back again."""

import numpy as np
import pytest

from tracking.model.course import Course
from tracking.smoother.coarsening import COARSE, coarser, every, finer, stride_of


def course(n: int, rng: np.random.Generator) -> Course:
    return Course(
        dt=1e-3,
        readings=rng.normal(size=(n, 3)),
        present=np.ones(n, dtype=bool),
        noise=np.array([1.0, 2.0, 3.0]),
        wander=np.array([0.1, 0.2, 0.3]),
        push=np.array([5.0, 6.0]),
        jolt=rng.uniform(size=(n, 2)),
        doubt=rng.uniform(1.0, 2.0, (n, 3)),
        rest=rng.uniform(1.0, 2.0, (n, 2)),
        rate=np.zeros(2),
    )


@pytest.mark.parametrize("n", [4, 8, 40])
def test_four_instants_become_one(n: int) -> None:
    fine = course(n, np.random.default_rng(0))
    coarse = coarser(fine, COARSE)
    assert COARSE == 4 and len(coarse.readings) == n // 4
    for k in range(n // 4):
        four = slice(4 * k, 4 * k + 4)
        assert coarse.readings[k] == pytest.approx(fine.readings[four].mean(axis=0))
        assert coarse.jolt[k] == pytest.approx(fine.jolt[four].sum(axis=0))
        assert coarse.doubt[k] == pytest.approx(fine.doubt[four].mean(axis=0))
        assert coarse.rest[k] == pytest.approx(fine.rest[four].mean(axis=0) / 4.0)
    assert coarse.present.all() and coarse.dt == pytest.approx(4e-3)
    assert coarse.noise == pytest.approx(fine.noise / 4.0)  # a mean of four has a quarter of the variance
    assert (coarse.wander == fine.wander).all() and (coarse.push == fine.push).all()


def test_readings_that_were_lost_weigh_nothing() -> None:
    fine = course(12, np.random.default_rng(1))
    fine.present[[1, 2]] = False
    fine.present[4:8] = False
    fine.present[8:11] = False  # one of the last four is left
    fine.readings[~fine.present] = 1e9
    coarse = coarser(fine, COARSE)
    assert coarse.readings[0] == pytest.approx(fine.readings[[0, 3]].mean(axis=0))
    assert coarse.present.tolist() == [True, False, True]
    assert coarse.readings[2] == pytest.approx(fine.readings[11])
    assert coarse.doubt[0] == pytest.approx(
        2.0 * fine.doubt[:4].mean(axis=0)
    )  # of two readings, twice the variance
    assert np.isfinite(coarse.readings).all() and np.isfinite(coarse.doubt).all()


def test_it_rests_where_it_rested_all_the_time() -> None:
    fine = course(8, np.random.default_rng(2))
    fine.rest[1, 0] = fine.rest[6, 1] = 0.0
    rest = coarser(fine, COARSE).rest
    assert (rest > 0.0).tolist() == [[False, True], [True, False]]


@pytest.mark.parametrize("n", [1, 5, 6, 7])
def test_a_last_few_are_filled_up_with_the_last(n: int) -> None:
    fine = course(n, np.random.default_rng(3))
    coarse = coarser(fine, COARSE)
    assert len(coarse.readings) == -(-n // 4)
    last = fine.readings[4 * ((n - 1) // 4) :]
    filled = np.concatenate([last, np.tile(last[-1], (4 - len(last), 1))])
    assert coarse.readings[-1] == pytest.approx(filled.mean(axis=0))


def test_the_middle_one_of_each_few_is_picked() -> None:
    values = np.arange(10.0)[:, None]
    picked = every(values, 4)
    assert picked.ravel().tolist() == [2.0, 6.0, 9.0]
    assert every(values, 1).ravel().tolist() == values.ravel().tolist()
    assert every(values, 3).ravel().tolist() == [1.0, 4.0, 7.0, 9.0]
    picked[0] = 99.0
    assert values.max() == 9.0  # it is a copy


@pytest.mark.parametrize("n", [1, 3, 4, 9, 12])
def test_a_straight_line_is_a_straight_line_again(n: int) -> None:
    """The states of a coarse pass are those of the middle of each few instants."""
    line = np.column_stack([np.arange(n), 3.0 - 0.5 * np.arange(n)])
    count = -(-n // 4)
    coarse = np.column_stack([4.0 * np.arange(count) + 2.0, 3.0 - 0.5 * (4.0 * np.arange(count) + 2.0)])
    fine = finer(coarse, n, COARSE)
    assert fine.shape == (n, 2)
    if count > 1:
        np.testing.assert_allclose(fine, line, atol=1e-12)
    else:
        np.testing.assert_allclose(fine, np.tile(coarse[0], (n, 1)))


@pytest.mark.parametrize(
    ("rate_hz", "stride"), [(1000.0, 4), (250.0, 4), (200.0, 3), (130.0, 2), (100.0, 1), (50.0, 1)]
)
def test_a_slow_recording_is_not_made_slower_still(rate_hz: float, stride: int) -> None:
    assert stride_of(1.0 / rate_hz) == stride
