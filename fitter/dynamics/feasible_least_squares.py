"""Least squares over all arms that masses can have: a convex search, and how near to the best it ends.

An arm is possible when every link's pseudo-inertia J is positive definite (Traversaro 2016) and every friction
above zero. J is linear in the standard parameters p, so these form a convex cone. The cost
``|A p - b|^2 + mu sum D(J, J0)`` is minimised for ever smaller mu. ``D = tr(J0^-1 J) - log det(J0^-1 J)`` keeps J
inside the cone (a barrier) and, in directions of which A says nothing, near the nominal J0 (Lee, Wensing and
Park 2020). A friction is a block of one row. For each mu there is one minimum, wherever the search begins; it is
followed by primal-dual steps in Nesterov and Todd's metric (1997).
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from arm.model import Floats
from arm.physical_links import pseudo_inertia
from limbcal.errors import NotConverged

#: A step aims at a mu this much smaller; or at the same one where an eigenvalue of JZ is not within this factor.
_SMALLER, _CENTRAL = 0.1, 0.2
#: The search has ended when the next step is shorter than this fraction of the way to the edge.
_STILL = 1e-2
_STEPS = 500
#: As far as a step may go towards the edge of the cone.
_TO_THE_EDGE = 0.9

#: The torque of the first arm's links, one by one, in units of the data's; and its weight, of the gradient there.
_HEAVY, _FIRST = 1000.0, 10.0

_HALF = np.sqrt(0.5)
_ROWS, _COLS = np.triu_indices(4)
_LINK, _SIDE = 10, 4


def _link_basis() -> Floats:
    """Return an orthonormal basis of the symmetric 4x4 matrices, (10, 4, 4)."""
    basis = np.zeros((_LINK, _SIDE, _SIDE))
    for k, (i, j) in enumerate(zip(_ROWS, _COLS, strict=True)):
        basis[k, i, j] = basis[k, j, i] = 1.0 if i == j else _HALF
    return basis


_BASIS = _link_basis()
#: vec(J) = _JACOBIAN p, and p = _INVERSE vec(J) for symmetric J.
_JACOBIAN = np.stack([pseudo_inertia(unit).ravel() for unit in np.eye(_LINK)], axis=1)
_INVERSE = np.linalg.pinv(_JACOBIAN)


@dataclass(frozen=True)
class PossibleOptimum:
    """Where the search has ended.

    Attributes
    ----------
    links : (n_link, 10)
        Standard inertial parameters, every pseudo-inertia positive definite.
    friction : (n_friction,)
        Above zero.
    cost : float
        ``|A p - b|^2``.
    mu : float
        No possible arm p' is cheaper by more than ``mu (4 n_link + n_friction + sum tr(J0^-1 J'))``.
    """

    links: Floats
    friction: Floats
    cost: float
    mu: float


def least_squares_possible(A: Floats, b: Floats, links: Floats, friction: Floats, mu: float) -> PossibleOptimum:
    """Minimise ``|A p - b|^2`` over possible links and frictions.

    Parameters
    ----------
    A, b : (n_row, 10 * n_link + n_friction), (n_row,)
    links, friction : (n_link, 10), (n_friction,)
        Nominal ones: possible links, frictions above zero. J0 has their shape; how heavy the arm is as a whole is
        taken from b.
    mu : float
        How near to the best to come, in units of the cost; see `PossibleOptimum`.

    Returns
    -------
    PossibleOptimum

    Raises
    ------
    NotConverged
        If rounding keeps it from coming that near.
    """
    here = _start(A, b, links, friction, mu)
    heavy, slope = np.linalg.inv(_pseudo_inertias(links)), 1.0 / friction
    first = np.linalg.inv(here.L @ _turned(here.L)), 1.0 / here.root**2
    for _ in range(_STEPS):
        products = here.products() / here.weight
        central = _CENTRAL < float(products.min()) and float(products.max()) < 1.0 / _CENTRAL
        target = max(mu, (_SMALLER if central else 1.0) * here.weight)
        to_links, to_friction = (
            mu * end + (target - mu) * begin for end, begin in zip((heavy, slope), first, strict=True)
        )
        here, moved = _step(A, b, to_links, to_friction, here, target)
        if here.weight <= mu and moved < _STILL:
            break
    else:
        raise NotConverged(
            f"no best arm was found among those that can exist, in {_STEPS} steps: the numbers are far from any "
            "such arm's, or differ too much in size; check the torque's sign, columns and units, and the arm's "
            "lengths"
        )
    p = here.standard()
    residual = A @ p - b
    cut = p.size - friction.size
    return PossibleOptimum(p[:cut].reshape(-1, _LINK), p[cut:], float(residual @ residual), mu)


@dataclass(frozen=True)
class _Iterate:
    """``J = L L^T`` and its multiplier ``Z = R R^T``; frictions ``root^2`` and theirs, ``force^2``.

    They are kept as factors: the products lose their small eigenvalues near the edge. Z is at all times the
    gradient of ``|A p - b|^2 + weight tr(J0^-1 J)``.
    """

    L: Floats
    R: Floats
    root: Floats
    force: Floats
    weight: float

    def products(self) -> Floats:
        """Return the eigenvalues of all JZ, each of which is mu where the minimum for mu is."""
        V = np.linalg.svd(_turned(self.R) @ self.L, compute_uv=False)
        return np.concatenate([V.ravel(), self.root * self.force]) ** 2

    def standard(self) -> Floats:
        """Return p."""
        J = self.L @ _turned(self.L)
        return np.concatenate([(J.reshape(len(J), -1) @ _INVERSE.T).ravel(), self.root**2])


def _start(A: Floats, b: Floats, links: Floats, friction: Floats, mu: float) -> _Iterate:
    """Begin far above any arm to be expected, and with such a weight on it that it is nearly the minimum.

    A link can lose mass as fast as steps allow; gaining it, it would take a step for every factor of two.
    """
    cut, torque = links.size, float(np.linalg.norm(b))
    felt = [
        float(np.linalg.norm(A[:, k : k + _LINK] @ links.ravel()[k : k + _LINK])) for k in range(0, cut, _LINK)
    ]
    larger = np.array([max(1.0, _HEAVY * torque / x) if x > 0.0 else 1.0 for x in felt])
    felt = np.linalg.norm(A[:, cut:], axis=0)
    d = np.where(felt > 0.0, np.maximum(friction, _HEAVY * torque / np.maximum(felt, 1e-300)), friction)
    L = np.asarray(np.linalg.cholesky(larger[:, None, None] * _pseudo_inertias(links)), dtype=np.float64)
    here = _Iterate(L, L, np.sqrt(d), d, mu)
    gradient = 2.0 * A.T @ (A @ here.standard() - b)
    pull = _turned(L) @ (gradient[:cut].reshape(-1, _LINK) @ _INVERSE).reshape(-1, _SIDE, _SIDE) @ L
    pull += mu * (larger[:, None, None] - 1.0) * np.eye(_SIDE)
    push = d * gradient[cut:] + mu * (d / friction - 1.0)
    size = max(float(np.abs(np.linalg.eigvalsh(pull)).max(initial=0.0)), float(np.abs(push).max(initial=0.0)))
    weight = max(mu, _FIRST * size)
    R = np.linalg.inv(_turned(L)) @ np.linalg.cholesky(pull + weight * np.eye(_SIDE))
    return replace(here, R=R, force=np.sqrt((push + weight) / d), weight=weight)


def _step(A: Floats, b: Floats, heavy: Floats, slope: Floats, here: _Iterate, mu: float) -> tuple[_Iterate, float]:
    """Take one step towards the minimum for mu, where ``JZ = mu`` and mu is the nominal arm's weight.

    In Nesterov and Todd's metric, ``J = U V U^T`` and ``Z = U^-T V U^-1`` with one diagonal V, the step
    ``U S U^T`` minimises ``|r + G s|^2 + |s|^2 / 2 + g.s``: plain least squares, of good condition however near
    to the edge J is. Returned with the iterate is how far it went, in units of V.
    """
    n_link = len(here.L)
    _, V, Qt = np.linalg.svd(_turned(here.R) @ here.L)
    U = here.L @ _turned(Qt) / np.sqrt(V)[:, None]
    v, u = here.root * here.force, here.root / here.force  # frictions are u v, their multipliers v / u
    moves = U[:, None] @ _BASIS @ _turned(U)[:, None]  # (n_link, 10, 4, 4)
    parameters = moves.reshape(n_link, _LINK, -1) @ _INVERSE.T
    columns = [A[:, _LINK * i : _LINK * (i + 1)] @ parameters[i].T for i in range(n_link)]
    G = np.hstack([*columns, A[:, _LINK * n_link :] * u])
    pull = np.einsum("lij,lkji->lk", heavy, moves) - np.einsum("li,kii->lk", mu / V, _BASIS)
    g = np.concatenate([pull.ravel(), slope * u - mu / v])
    r = A @ here.standard() - b
    rows, right = np.vstack([G, _HALF * np.eye(G.shape[1])]), -np.concatenate([r, _HALF * g])
    Q, triangle = np.linalg.qr(rows)
    step = np.asarray(scipy.linalg.solve_triangular(triangle, Q.T @ right), dtype=np.float64)
    S = np.einsum("lk,kij->lij", step[: _LINK * n_link].reshape(n_link, _LINK), _BASIS)
    s = step[_LINK * n_link :]
    D = V[:, :, None] * np.eye(_SIDE)
    T, t = mu / V[:, :, None] * np.eye(_SIDE) - D - S, mu / v - v - s  # the multipliers' step
    near = 1.0 / np.sqrt(V[:, :, None] * V[:, None])
    lowest = min(
        *(float(np.linalg.eigvalsh(near * X).min(initial=0.0)) for X in (S, T)),
        *(float((x / v).min(initial=0.0)) for x in (s, t)),
    )
    share = min(1.0, -_TO_THE_EDGE / lowest) if lowest < 0.0 else 1.0
    moved = max(float(np.abs(near * S).max(initial=0.0)), float(np.abs(s / v).max(initial=0.0)))
    there = _Iterate(
        U @ np.linalg.cholesky(D + share * S),
        _turned(np.linalg.inv(U)) @ np.linalg.cholesky(D + share * T),
        np.sqrt(u * (v + share * s)),
        np.sqrt((v + share * t) / u),
        mu if share == 1.0 else here.weight + share * (mu - here.weight),
    )
    return there, moved


def _pseudo_inertias(links: Floats) -> Floats:
    return np.asarray((links @ _JACOBIAN.T).reshape(-1, _SIDE, _SIDE), dtype=np.float64)


def _turned(matrices: Floats) -> Floats:
    return np.swapaxes(matrices, -1, -2)
