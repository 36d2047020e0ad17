"""The elimination against plain dense least squares."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.reading_diagnosis.elimination import eliminate, go_back, motion_at_knots


def dense(S, E, X, h, walk, first):
    """Return all equations as one matrix over c, e and X, in the order of the unknowns."""
    n, n_row, n_joint = S.shape[0], S.shape[1], S.shape[2] // 3
    m, p = E.shape[2], X.shape[2]
    n_c = (n + 2) * n_joint
    rows = []
    for i in range(2 * n_joint):
        rows.append(np.eye(1, n_c + n * m + p, i)[0])
    for i in range(m):
        before = np.zeros(n_c + n * m + p)  # where the walk begins, a step before the first frame
        before[n_c + i] = 1.0 / np.sqrt(1.0 / first[i] ** 2 + 1.0 / walk[i] ** 2)
        rows.append(before)
    for k in range(1, n):
        for i in range(m):
            step = np.zeros(n_c + n * m + p)
            step[n_c + (k - 1) * m + i], step[n_c + k * m + i] = -walk[i], walk[i]
            rows.append(step)
    basis = np.array([[1 / 6, 4 / 6, 1 / 6], [-0.5 / h, 0.0, 0.5 / h], [1 / h**2, -2 / h**2, 1 / h**2]])
    for k in range(n):
        for row in range(n_row):
            line = np.zeros(n_c + n * m + p)
            for j in range(n_joint):
                for knot in range(3):
                    line[(k + knot) * n_joint + j] = S[k, row, 3 * j : 3 * j + 3] @ basis[:, knot]
            line[n_c + k * m : n_c + (k + 1) * m] = E[k, row]
            line[n_c + n * m :] = X[k, row]
            rows.append(line)
    return np.array(rows), n_c


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), n_joint=st.integers(1, 3), m=st.integers(0, 3), p=st.integers(1, 4))
def test_what_is_left_is_what_dense_least_squares_leaves(seed, n_joint, m, p):
    rng = np.random.default_rng(seed)
    n, n_row, h = 9, 3 * n_joint + 4, 0.7
    S, E = rng.normal(size=(n, n_row, 3 * n_joint)), rng.normal(size=(n, n_row, m))
    X, walk, first = rng.normal(size=(n, n_row, p)), rng.uniform(0.5, 2.0, m), rng.uniform(0.5, 2.0, m)
    gram, back = np.empty((p, p)), np.empty((n + 2, n_joint + m, 3 * n_joint + 2 * m + p))
    eliminate(S, E, X, h, walk, first, gram, back)
    rows, n_c = dense(S, E, X, h, walk, first)
    unknown = n_c + n * m
    moved = np.linalg.lstsq(rows[:, :unknown], rows[:, unknown:], rcond=None)[0]
    left = rows[:, unknown:] - rows[:, :unknown] @ moved
    np.testing.assert_allclose(gram, left.T @ left, atol=1e-8)

    theta = rng.normal(size=p - 1)
    c, e = np.empty((n + 2, n_joint)), np.empty((n, m))
    go_back(back, theta, n_joint, c, e)
    right = rows[:, -1] - rows[:, unknown:-1] @ theta
    best = np.linalg.lstsq(rows[:, :unknown], right, rcond=None)[0]
    np.testing.assert_allclose(c.ravel(), best[:n_c], atol=1e-8)
    np.testing.assert_allclose(e.ravel(), best[n_c:], atol=1e-8)


def test_a_cubic_is_its_own_spline():
    h, t = 0.1, 0.1 * np.arange(-1, 12)
    # The coefficients of t^3, t^2 and t follow from their blossom at three neighbouring knots.
    c = ((t - h) * t * (t + h))[:, None]
    q, dq, ddq = np.empty((3, 11, 1))
    motion_at_knots(c, h, q, dq, ddq)
    at = t[1:-1, None]
    np.testing.assert_allclose(q, at**3, atol=1e-12)
    np.testing.assert_allclose(dq, 3 * at**2, atol=1e-12)
    np.testing.assert_allclose(ddq, 6 * at, atol=1e-10)
