"""Inertial parameters as a deformation of a body that can exist: ten free numbers, always a possible body.

The pseudo-inertia of a body is ``J0 = B B^T`` with ``B = sqrt(m) [[C, c], [0, 1]]``: c its centre of mass, and C
the symmetric root of its second moments about c, a matrix of radii of gyration. The deformed one is

    ``J = e^mu B V V^T B^T``  with  ``V = [[S, t], [0, 1]]``.

mu is the logarithm of how much heavier it is, t the shift of its centre in units of those radii, and S an upper
triangle whose diagonal is an exponential: an affine map of all mass about its centre. That is the log-Cholesky
form of Rucker and Wensing (2022) seen from a nominal body, with numbers of no unit that a prior can be put on.
"""

import numpy as np

from arm.model import Floats
from arm.physical_links import pseudo_inertia

#: Numbers a body: mu, t (3), then S: its diagonal (3) and what is above it (3).
N_BODY = 10
MASS, SHIFT, SHAPE = 0, slice(1, 4), slice(4, 10)
_DIAGONAL = [0, 1, 2]
_ABOVE = [(0, 1), (0, 2), (1, 2)]


def radii(links: Floats) -> Floats:
    """Return C of bodies, (n_body, 3, 3) [m].

    Parameters
    ----------
    links : (n_body, 10)
        Standard parameters of bodies that can exist.
    """
    C = np.empty((len(links), 3, 3))
    for k, link in enumerate(links):
        J = pseudo_inertia(link)
        c = J[:3, 3] / J[3, 3]
        value, axes = np.linalg.eigh(J[:3, :3] / J[3, 3] - np.outer(c, c))
        C[k] = axes @ np.diag(np.sqrt(value)) @ axes.T
    return C


class Deformation:
    """Maps ten numbers a body to standard parameters.

    Parameters
    ----------
    links : (n_body, 10)
        Nominal bodies, each with a positive definite pseudo-inertia.
    """

    def __init__(self, links: Floats) -> None:
        self.links = links
        B = np.zeros((len(links), 4, 4))
        B[:, :3, :3] = radii(links)
        B[:, :3, 3] = links[:, 6:9] / links[:, 9:]
        B[:, 3, 3] = 1.0
        self._root = np.sqrt(links[:, 9])[:, None, None] * B

    @property
    def size(self) -> int:
        """Numbers of all bodies."""
        return N_BODY * len(self.links)

    def parameters(self, x: Floats) -> Floats:
        """Return the standard parameters, (10 n_body,), at x, (10 n_body,)."""
        mu, V = self._parts(x)
        return _standard(_product(self._root @ V) * np.exp(mu)[:, None, None]).ravel()

    def slopes(self, x: Floats) -> Floats:
        """Return their derivatives, (10 n_body, 10 n_body): one block a body."""
        mu, V = self._parts(x)
        n = len(self.links)
        scale = np.exp(mu)[:, None, None]
        left = scale * (self._root @ V)
        out = np.zeros((n, 10, n, N_BODY))
        each = np.arange(n)
        for k in range(N_BODY):
            if k == MASS:
                change = left @ (self._root @ V).transpose(0, 2, 1)
            else:
                dV = np.zeros((n, 4, 4))
                if k < SHAPE.start:
                    dV[:, k - SHIFT.start, 3] = 1.0
                elif k < SHAPE.start + 3:
                    i = k - SHAPE.start
                    dV[:, i, i] = V[:, i, i]
                else:
                    dV[:, *_ABOVE[k - SHAPE.start - 3]] = 1.0
                half = (self._root @ dV) @ left.transpose(0, 2, 1)
                change = half + half.transpose(0, 2, 1)
            out[each, :, each, k] = _standard(change)
        return out.reshape(10 * n, N_BODY * n)

    def _parts(self, x: Floats) -> tuple[Floats, Floats]:
        rows = x.reshape(-1, N_BODY)
        V = np.zeros((len(rows), 4, 4))
        V[:, 3, 3] = 1.0
        V[:, :3, 3] = rows[:, SHIFT]
        V[:, _DIAGONAL, _DIAGONAL] = np.exp(rows[:, SHAPE.start : SHAPE.start + 3])
        for column, (i, j) in enumerate(_ABOVE, SHAPE.start + 3):
            V[:, i, j] = rows[:, column]
        return rows[:, MASS], V


def _product(root: Floats) -> Floats:
    return np.asarray(root @ root.transpose(0, 2, 1))


def _standard(J: Floats) -> Floats:
    """Return ``xx yy zz xy xz yz, m*sx m*sy m*sz, m`` of pseudo-inertias, (n, 10)."""
    second = np.einsum("nii->ni", J[:, :3, :3])
    tensor = second.sum(axis=1, keepdims=True) - second
    products = -np.column_stack([J[:, 0, 1], J[:, 0, 2], J[:, 1, 2]])
    return np.hstack([tensor, products, J[:, :3, 3], J[:, 3, 3, None]])
