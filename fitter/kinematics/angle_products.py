"""Products of joint angles as they would be without the angles' noise.

Let an angle be measured as q + e with Gaussian noise e of variance v. Then ``E exp(ik(q + e)) = exp(-k^2 v/2)
exp(ikq)``, so a harmonic is undone by a factor; of a joint that slides the powers are undone by Hermite
polynomials, ``E[(q + e)^2 - v] = q^2``. Noise of different joints is independent, so a product of several is
undone joint by joint. All that follows holds in expectation exactly, whatever the angles did.
"""

from collections.abc import Sequence
from math import comb, prod

import numpy as np

from arm.model import Floats
from fitter.kinematics.tip_basis import Complexes


def orders(turns: bool, longest: int) -> range:
    """Return the harmonics of a joint that turns, or the powers of one that slides."""
    return range(-longest if turns else 0, longest + 1)


def places(revolute: Sequence[bool], longest: int) -> tuple[int, ...]:
    """Return how many orders each joint has."""
    return tuple(len(orders(turns, longest)) for turns in revolute)


def products(revolute: Sequence[bool], q: Floats, longest: int) -> Complexes:
    """Return the products of one harmonic or power for every joint, joint 1 the slowest, (n_sample, n_place)."""
    table: Complexes = np.ones((len(q), 1), dtype=complex)
    for turns, angle in zip(revolute, q.T, strict=True):
        own = angle[:, None] * np.array(orders(turns, longest))
        own = np.exp(1j * own) if turns else angle[:, None] ** np.array(orders(turns, longest))
        table = (table[:, :, None] * own[:, None, :]).reshape(len(q), -1)
    return table


def undone(revolute: Sequence[bool], table: Complexes, longest: int, variance: Floats) -> Complexes:
    """Return unbiased products of true angles from those of measured ones.

    Parameters
    ----------
    revolute : (n_joint,) bool
    table : (…, n_place)
        From `products`, or linear in them.
    longest : int
    variance : (n_joint,) [rad^2 or m^2]
        Of the noise.

    Returns
    -------
    (…, n_place)
    """
    shape = places(revolute, longest)
    rows = prod(table.shape[:-1])
    out = table.reshape(rows, *shape)
    for joint, turns in enumerate(revolute):
        if turns:
            factor = np.exp(0.5 * variance[joint] * np.arange(-longest, longest + 1) ** 2)
            out = out * factor.reshape(-1, *(1,) * (len(shape) - joint - 1))
        else:
            powers = np.moveaxis(out, joint + 1, -1) @ _hermite(longest, variance[joint]).T
            out = np.moveaxis(powers, -1, joint + 1)
    return out.reshape(table.shape)


def undone_gram(revolute: Sequence[bool], gram: Floats, variance: Floats) -> Floats:
    """Return unbiased ``phi phi^T`` of true angles from that of measured ones.

    Parameters
    ----------
    revolute : (n_joint,) bool
    gram : (n_block, n_basis, n_basis)
        Sums of ``phi phi^T`` with the constant, of `fitter.kinematics.tip_basis.basis`.
    variance : (n_joint,)

    Returns
    -------
    (n_block, n_basis, n_basis)
    """
    n, own = len(revolute), [3 if turns else 2 for turns in revolute]
    out = gram.reshape(len(gram), *own, *own)
    for joint, turns in enumerate(revolute):
        v, size = variance[joint], own[joint]
        squares = np.moveaxis(out, (1 + joint, 1 + n + joint), (-2, -1)).copy()
        if turns:
            once, twice = np.exp(0.5 * v), np.exp(2.0 * v)
            squares[..., 0, 1:] *= once
            squares[..., 1:, 0] *= once
            cos_cos, sin_sin = squares[..., 1, 1].copy(), squares[..., 2, 2].copy()
            squares[..., 1, 1] = 0.5 * (cos_cos + sin_sin + twice * (cos_cos - sin_sin))
            squares[..., 2, 2] = 0.5 * (cos_cos + sin_sin - twice * (cos_cos - sin_sin))
            squares[..., 1, 2] *= twice
            squares[..., 2, 1] *= twice
        else:
            squares[..., 1, 1] -= v * squares[..., 0, 0]
        out = np.moveaxis(squares.reshape(*squares.shape[:-2], size, size), (-2, -1), (1 + joint, 1 + n + joint))
    return np.ascontiguousarray(out.reshape(gram.shape))


def basis_factor(revolute: Sequence[bool], variance: Floats) -> Floats:
    """Return what undoes the noise in phi itself, a factor for each of its products, (n_basis,)."""
    factor = np.ones(1)
    for turns, v in zip(revolute, variance, strict=True):
        once = np.exp(0.5 * v)
        factor = np.kron(factor, np.array([1.0, once, once] if turns else [1.0, 1.0]))
    return factor


def _hermite(longest: int, variance: float) -> Floats:
    """Return H with ``E[H (1, q + e, (q + e)^2, …)] = (1, q, q^2, …)``."""
    H = np.zeros((longest + 1, longest + 1))
    for k in range(longest + 1):
        for j in range(k // 2 + 1):
            H[k, k - 2 * j] = comb(k, 2 * j) * prod(range(1, 2 * j, 2)) * (-variance) ** j
    return H
