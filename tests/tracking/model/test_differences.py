"""Derivatives of a stream: exact where they can be, the same in any pieces, none across a standstill."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracking.model.differences import CentralDifferences

FEW = settings(max_examples=50, deadline=None)
DT = 1e-3
T = DT * np.arange(40)[:, None]
Q = np.hstack([0.3 + 2.0 * T - 5.0 * T**2, np.sin(30 * T)])


def derived(pieces, dt=DT):
    """Return the derivatives of pieces (angles, held), one after the other."""
    stream = CentralDifferences(dt, 2)
    out = [stream.push(q, held) for q, held in pieces] + [stream.flush()]
    return np.vstack([dq for dq, _ in out]), np.vstack([ddq for _, ddq in out])


def test_a_parabola_has_its_derivatives():
    dq, ddq = derived([(Q, False)])
    np.testing.assert_allclose(dq[1:-1, 0], (2.0 - 10.0 * T)[1:-1, 0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(ddq[1:-1, 0], -10.0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(dq[[0, -1], 0], (2.0 - 10.0 * T)[[0, -1], 0], rtol=0, atol=0.01)  # one-sided
    assert ddq[0, 0] == pytest.approx(0.0, abs=1e-9) and ddq[-1, 0] == pytest.approx(-10.0)


def test_a_stream_is_one_frame_behind():
    stream = CentralDifferences(DT, 2)
    assert len(stream.push(Q[:5], False)[0]) == 4
    assert len(stream.push(Q[5:8], False)[0]) == 3
    assert len(stream.push(Q[8:9], True)[0]) == 1
    assert len(stream.flush()[0]) == 1
    assert len(stream.flush()[0]) == 0


@FEW
@given(st.lists(st.integers(1, 7), min_size=1, max_size=12))
def test_pieces_of_any_size_give_the_same(sizes):
    cuts = np.cumsum(sizes)
    pieces = [(q, False) for q in np.split(Q, cuts[cuts < len(Q)]) if len(q)]
    for found, whole in zip(derived(pieces), derived([(Q, False)]), strict=True):
        np.testing.assert_array_equal(found, whole)


@FEW
@given(st.lists(st.tuples(st.integers(1, 5), st.booleans()), min_size=1, max_size=8))
def test_every_frame_gets_its_derivatives_once(plan):
    edges = np.minimum(np.cumsum([0] + [n for n, _ in plan]), len(Q))
    pieces = [(Q[a:b], held) for (_, held), a, b in zip(plan, edges[:-1], edges[1:], strict=True) if b > a]
    dq, ddq = derived(pieces)
    assert len(dq) == len(ddq) == edges[-1]
    for (_, held), a, b in zip(plan, edges[:-1], edges[1:], strict=True):
        if held:
            np.testing.assert_array_equal(dq[a:b], 0.0)
            np.testing.assert_array_equal(ddq[a:b], 0.0)


def test_the_jump_of_a_recognised_rest_is_no_motion():
    """Before the rest it moves at 2 rad/s, then it is set still: neither 2000 rad/s^2 nor half the speed."""
    moving = np.repeat(2.0 * DT * np.arange(20)[:, None], 2, axis=1)
    dq, ddq = derived([(moving, False), (np.tile(moving[-1], (5, 1)), True)])
    np.testing.assert_allclose(dq[:20], 2.0, rtol=1e-9)
    np.testing.assert_allclose(ddq[:20], 0.0, rtol=0, atol=1e-6)
    np.testing.assert_array_equal(dq[20:], 0.0)


def test_a_single_frame_is_not_known_to_move():
    dq, ddq = derived([(Q[:1], False)])
    assert dq.tolist() == ddq.tolist() == [[0.0, 0.0]]


def test_a_first_frame_that_comes_alone_waits_for_the_second():
    dq, _ = derived([(Q[:1], False), (Q[1:], False)])
    np.testing.assert_array_equal(dq, derived([(Q, False)])[0])
    assert dq[0, 1] == pytest.approx(np.sin(0.03) / DT)


def test_after_a_flush_it_begins_anew():
    stream = CentralDifferences(DT, 2)
    stream.push(Q, False)
    stream.flush()
    dq, _ = stream.push(Q + 100.0, False)
    assert np.abs(dq).max() < 31.0
