"""Sums of a trial that comes in portions."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.chain import chain_of
from arm.regressor import regressor
from fitter.regression_sums.running_sums import RunningSums
from fitter.regression_sums.torque_sums import finished, row_sums, torque_sums

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = np.array(BASE.independent)
SUMS = ("gram", "moment", "power", "row", "torque", "count")


def running_of(motion, ends, samples=None):
    running = RunningSums(2, 8, samples)
    bounds = sorted({0, *(end for end in ends if end < len(motion[0])), len(motion[0])})
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        running.add_motion(chain_of(ARM), COLUMNS, *(values[begin:end] for values in motion), rest_speed=0.1)
    return finished(running)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 3000), st.lists(st.integers(1, 3000), max_size=6), st.booleans())
def test_portions_make_no_difference_to_the_last_bit(n, ends, known):
    motion = np.random.default_rng(n).normal(size=(4, n, 2))
    samples = n if known else None
    parted, whole = running_of(motion, ends, samples), running_of(motion, [], samples)
    for name in SUMS:
        assert np.array_equal(getattr(parted, name), getattr(whole, name))
    assert parted.samples == n


def test_blocks_merge_where_the_length_is_not_known():
    n = 700_001  # five times what blocks of the first length hold
    motion = np.random.default_rng(0).normal(size=(4, n, 2))
    growing, known = running_of(motion, range(0, n, 90_000)), torque_sums(ARM, BASE, *motion, rest_speed=0.1)
    assert 64 <= len(growing.trial) <= 128
    counts = growing.count.sum(axis=1)
    assert np.ptp(counts[:-1]) < 0.02 * counts[0]
    for name in SUMS:
        assert np.allclose(getattr(growing.total(), name), getattr(known.total(), name), rtol=1e-11, atol=1e-7)


def test_a_part_of_the_samples_is_where_they_stand():
    """The blocks of a trial of known length are those of the whole, however few samples were added."""
    motion = np.random.default_rng(1).normal(size=(4, 1000, 2))
    some = running_of(motion[:, :300], [], samples=1000)
    whole = torque_sums(ARM, BASE, *motion, rest_speed=0.1)
    full = len(some.trial) - 1
    assert np.array_equal(some.gram[:full], whole.gram[:full])


def test_equations_in_portions_are_those_of_the_whole():
    q, dq, ddq, tau = np.random.default_rng(2).normal(size=(4, 2000, 2))
    rows = regressor(ARM, q, dq, ddq)[..., BASE.independent]
    moving = np.abs(dq) > 0.1
    running = RunningSums(2, 8, 2000)
    for begin in range(0, 2000, 333):
        part = slice(begin, begin + 333)
        running.add_equations(rows[part], tau[part], moving[part])
    parted, whole = finished(running), row_sums(rows, tau, moving)
    W = np.where(moving[..., None], rows, 0.0)
    assert np.allclose(whole.gram.sum(axis=0), np.einsum("kja,kjb->jab", W, W))
    for name in SUMS:
        assert np.array_equal(getattr(parted, name), getattr(whole, name))


def test_many_parameters_take_no_more_memory_than_allowed():
    running = RunningSums(7, 60)
    assert sum(array.nbytes for array in running.arrays()) < 8_000_000
