"""How one segment moved relative to its neighbour, summed up part by part.

With parent's and child's poses ``R, p`` and ``S, q``, a point that is fixed in both, ``u`` in the parent and
``v`` in the child, obeys ``R u + p = S v + q`` in every frame (Ehrig et al. 2006). Its normal equations
over n frames need no more than the mean relative rotation ``Q`` and the mean places of the origins in each
other:

    u - Q v = s,  v - Q^T u = t,  Q = mean R^T S,  s = mean R^T (q - p),  t = mean S^T (p - q)

With ``Q = sum_k sigma_k a_k b_k^T`` they fall apart into three pairs of equations. A direction ``a_k`` that is
turned about no other axis has ``sigma_k = 1``; the rms turn that moves it is ``sqrt(2 (1 - sigma_k))``.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.disjoint import Parts, disjoint_parts
from fitter.functional.rigid_fit import Poses


@dataclass(frozen=True)
class RelativeMotion:
    """Frames of all trials in which both segments have a pose.

    Attributes
    ----------
    R, S : (n, 3, 3)
        Parent and child to world.
    p, q : (n, 3)
        Their origins in the world [m].
    parts : Parts
        Of these frames.
    used : (n_frame,) bool
        Which of the frames of all trials, one after the other, they are.
    """

    R: Floats
    p: Floats
    S: Floats
    q: Floats
    parts: Parts
    used: NDArray[np.bool_]

    @property
    def n_frame(self) -> int:
        """How many frames there are."""
        return len(self.p)


@dataclass(frozen=True)
class PartSums:
    """Normal equations of ``[R, -S] (u, v) = q - p`` by part, however weighted.

    Attributes
    ----------
    gram : (n_part, 6, 6)
    rhs : (n_part, 6)
    """

    gram: Floats
    rhs: Floats


@dataclass(frozen=True)
class Turning:
    """What turned in the joint: principal directions of the mean relative rotation.

    Attributes
    ----------
    in_parent, in_child : (3, 3)
        Row k is direction ``a_k`` and ``b_k``; the first is the one that is turned least.
    sigma : (3,)
        Singular values of the mean relative rotation, the largest first.
    """

    in_parent: Floats
    in_child: Floats
    sigma: Floats

    @property
    def turned_rad(self) -> Floats:
        """How far the rotations turn each direction away, rms, (3,) [rad]: what sees a centre's place along it."""
        return np.asarray(np.sqrt(2.0 * np.maximum(1.0 - self.sigma, 0.0)))

    @property
    def about_rad(self) -> Floats:
        """How far the rotations go about each direction, rms, (3,) [rad]; of small rotations exactly."""
        squares = self.turned_rad**2
        return np.asarray(np.sqrt(np.maximum(squares.sum() / 2.0 - squares, 0.0)))


def relative_motion(parent: Sequence[Poses], child: Sequence[Poses]) -> RelativeMotion:
    """Return the frames of all trials in which both segments have a pose; poses come trial by trial."""
    both = [a.valid & b.valid for a, b in zip(parent, child, strict=True)]
    parts = disjoint_parts(both)
    used = parts.part >= 0
    R, S = (np.concatenate([poses.R for poses in segment])[used] for segment in (parent, child))
    p, q = (np.concatenate([poses.p for poses in segment])[used] for segment in (parent, child))
    return RelativeMotion(R, p, S, q, Parts(parts.part[used], parts.trial[used]), used)


def part_sums(motion: RelativeMotion, group: NDArray[np.intp], weight: Floats | None = None) -> PartSums:
    """Sum up the normal equations.

    Parameters
    ----------
    motion : RelativeMotion
    group : (n,) int
        Which part or trial a frame belongs to.
    weight : (n, 3, 3), optional
        In the world, of the three equations of a frame.
    """
    A = np.concatenate([motion.R, -motion.S], axis=2)
    b = motion.q - motion.p
    left = A.transpose(0, 2, 1) if weight is None else A.transpose(0, 2, 1) @ weight
    n = int(group.max(initial=-1)) + 1
    gram, rhs = np.zeros((n, 6, 6)), np.zeros((n, 6))
    np.add.at(gram, group, left @ A)
    np.add.at(rhs, group, np.einsum("nij,nj->ni", left, b))
    return PartSums(gram, rhs)


def turning(gram: Floats) -> Turning:
    """Return the principal directions of the mean relative rotation, from unweighted normal equations (6, 6)."""
    Q: Floats = -gram[:3, 3:] / (np.trace(gram) / 6.0)
    U, sigma, Vt = np.linalg.svd(Q)
    return Turning(np.asarray(U.T), np.asarray(Vt), np.minimum(sigma, 1.0))
