r"""What readings say that no motion of the arm can explain: the motion eliminated by orthogonal transformations.

A trial's motion is a cubic spline with a knot at every frame, so at a frame q, dq and ddq depend on three
coefficients a joint and the acceleration is free from frame to frame. The linearised readings are

    r_k = S_k δ(q, dq, ddq)_k + E_k e_k + X_k θ + noise,     e_k = e_{k-1} + step

with e a random walk, for what wanders (a forgetful sensor) or is free (a moving base). Frame after frame
Householder reflections triangularise the window of coefficients in use: finished rows are set aside for going
back, and rows that are left without any motion in them contradict a rigid arm. Under the right θ those are white
noise of unit variance, as an orthogonal transformation of white noise is, whatever the motion was. All that a fit
needs of them is their Gram matrix. (G. J. Bierman, *Factorization Methods for Discrete Sequential
Estimation*, 1977.)
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled


@compiled
def motion_at_knots(c: Floats, h: float, q: Floats, dq: Floats, ddq: Floats) -> None:
    """Fill in q, dq, ddq (n, n_joint) of a spline with coefficients c (n + 2, n_joint)."""
    for k in range(q.shape[0]):
        for j in range(c.shape[1]):
            a, b, d = c[k, j], c[k + 1, j], c[k + 2, j]
            q[k, j] = (a + 4.0 * b + d) / 6.0
            dq[k, j] = (d - a) / (2.0 * h)
            ddq[k, j] = (a - 2.0 * b + d) / (h * h)


@compiled
def eliminate(
    S: Floats, E: Floats, X: Floats, h: float, walk: Floats, first: Floats, gram: Floats, back: Floats
) -> None:
    """Eliminate a trial's motion.

    Parameters
    ----------
    S : (n, n_row, 3 n_joint)
        Slopes by q, dq, ddq of joint 1, then of joint 2 and so on; rows have noise of unit variance.
    E : (n, n_row, m)
        Slopes by what walks.
    X : (n, n_row, p)
        Columns of θ, and last what is to be explained.
    h : float
        From frame to frame [s].
    walk, first : (m,)
        One over the standard deviation of a step, and of where the walk begins.
    gram : (p, p)
        Filled in: Gram matrix of the residual of X.
    back : (n, n_joint + m, 3 n_joint + 2 m + p)
        Filled in: finished rows over e_{k-1}, c_{k-1}, c_k, c_{k+1}, e_k, X; the last frame has those of the end
        in ``back[n]`` and ``back[n + 1]``, so the first dimension is n + 2.
    """
    n, n_row, n_joint = S.shape[0], S.shape[1], S.shape[2] // 3
    m, p = E.shape[2], X.shape[2]
    kept, wide = 2 * n_joint + m, 3 * n_joint + 2 * m
    rows, done = kept + m + n_row, n_joint + m
    A = np.zeros((rows, wide + p))
    carried = np.zeros((kept, wide + p))
    for i in range(m):
        carried[i, i] = first[i]
    for i in range(2 * n_joint):
        carried[m + i, m + i] = 1.0  # held to where they are by one radian or metre, which is nothing
    gram[:] = 0.0
    for k in range(n):
        A[:kept] = carried
        A[kept:] = 0.0
        for i in range(m):
            A[kept + i, i] = -walk[i]
            A[kept + i, m + 3 * n_joint + i] = walk[i]
        for row in range(n_row):
            line = A[kept + m + row]
            window_row(S[k, row], h, line[m : m + 3 * n_joint])
            line[m + 3 * n_joint : wide] = E[k, row]
            line[wide:] = X[k, row]
        triangularise(A, wide)
        back[k] = A[:done]
        # The next window begins with e_k, c_k, c_{k+1}.
        carried[:, :m] = A[done : done + kept, m + 3 * n_joint : wide]
        carried[:, m:kept] = A[done : done + kept, done : done + 2 * n_joint]
        carried[:, kept:wide] = 0.0
        carried[:, wide:] = A[done : done + kept, wide:]
        add_products(A[wide:, wide:], gram)
    triangularise(carried, kept)
    back[n:] = 0.0
    for i in range(kept):
        back[n + i // done, i % done] = carried[i]
    for a in range(p):
        for b in range(a):
            gram[b, a] = gram[a, b]


@compiled
def add_products(rows: Floats, gram: Floats) -> None:
    """Add the products of the columns of some rows to the lower half of their Gram matrix."""
    for line in rows:
        for a in range(line.size):
            if line[a] != 0.0:
                for b in range(a + 1):
                    gram[a, b] += line[a] * line[b]


@compiled
def window_row(s: Floats, h: float, line: Floats) -> None:
    """Fill in a row's slopes by c_{k-1}, c_k, c_{k+1}, from those by q, dq, ddq of every joint (3 n_joint,)."""
    n_joint = s.size // 3
    for j in range(n_joint):
        s0, s1, s2 = s[3 * j], s[3 * j + 1] / (2.0 * h), s[3 * j + 2] / (h * h)
        line[j] = s0 / 6.0 - s1 + s2
        line[n_joint + j] = 4.0 * s0 / 6.0 - 2.0 * s2
        line[2 * n_joint + j] = s0 / 6.0 + s1 + s2


@compiled
def triangularise(A: Floats, wide: int) -> None:
    """Make the first columns of A upper triangular by Householder reflections of its rows."""
    rows, columns = A.shape
    v, dot = np.empty(rows), np.empty(columns)
    for col in range(wide):
        square = 0.0
        for i in range(col, rows):
            v[i] = A[i, col]
            square += v[i] * v[i]
        if square == 0.0:
            continue
        length = np.sqrt(square)
        turned = -length if v[col] > 0.0 else length
        v[col] -= turned
        factor = 1.0 / (square - turned * A[col, col])  # 2 over the reflector's squared length
        dot[col:] = 0.0
        for i in range(col, rows):
            if v[i] != 0.0:
                for j in range(col, columns):
                    dot[j] += v[i] * A[i, j]
        for i in range(col, rows):
            if v[i] != 0.0:
                scaled = factor * v[i]
                for j in range(col, columns):
                    A[i, j] -= scaled * dot[j]
        A[col, col] = turned
        for i in range(col + 1, rows):
            A[i, col] = 0.0


@compiled
def go_back(back: Floats, theta: Floats, n_joint: int, c: Floats, e: Floats) -> None:
    """Fill in the motion's change and the walk that go with θ.

    Parameters
    ----------
    back : (n + 2, n_joint + m, …)
        From `eliminate`.
    theta : (p - 1,)
    n_joint : int
    c : (n + 2, n_joint)
    e : (n, m)
    """
    n, done = c.shape[0] - 2, back.shape[1]
    m = done - n_joint
    kept, wide = 2 * n_joint + m, 3 * n_joint + 2 * m
    x = np.zeros(wide)  # e_{k-1}, c_{k-1}, c_k, c_{k+1}, e_k
    for i in range(kept - 1, -1, -1):
        line = back[n + i // done, i % done]
        x[i] = solved(line, theta, x, i, kept, wide)
    e[n - 1] = x[:m]
    c[n] = x[m : m + n_joint]
    c[n + 1] = x[m + n_joint : kept]
    for k in range(n - 1, -1, -1):
        x[wide - m :] = e[k]
        x[done : done + n_joint] = c[k + 1]
        x[done + n_joint : done + 2 * n_joint] = c[k + 2]
        for i in range(done - 1, -1, -1):
            x[i] = solved(back[k, i], theta, x, i, wide, wide)
        c[k] = x[m:done]
        if k > 0:
            e[k - 1] = x[:m]


@compiled
def solved(line: Floats, theta: Floats, x: Floats, i: int, end: int, wide: int) -> float:
    """Return the unknown on the diagonal of one finished row."""
    total: float = line[line.size - 1]
    for a in range(theta.size):
        total -= line[wide + a] * theta[a]
    for j in range(i + 1, end):
        total -= line[j] * x[j]
    found: float = total / line[i]
    return found
