"""What a kinematic fit needs of the data: sums of products of the tip's basis and its displacement.

Accelerometers measure how far the tip has come since a rest, not where it is; so the basis of
`fitter.kinematics.tip_basis` is taken as its difference from that rest too, in which all that is constant drops
out. Old frames are never looked at again: new ones are added to the sums, and a generation costs the same after
an hour as after a second.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from arm.chain import joint_rows
from arm.model import Arm, Floats
from fitter.kinematics.angle_products import basis_factor, undone_gram
from fitter.kinematics.tip_basis import basis, turning
from fitter.search.whitened import Whitened, whiten
from limbcal.errors import DataError

#: Blocks of one trial, and of a whole stream; and the memory that they may take.
_BLOCKS = 128
_ALL_BLOCKS = 4096
_BLOCK_BYTES = 64_000_000
#: Samples that are turned into basis functions at a time.
_CHUNK = 8192


@dataclass(frozen=True)
class TipSums:
    """Sums over blocks of consecutive samples.

    Attributes
    ----------
    gram : (n_block, n_basis - 1, n_basis - 1)
        Of the basis differences: phi^T phi, without the constant.
    moment : (n_block, n_basis - 1, 3)
        phi^T r*.
    power : (n_block, 3)
        r*^T r*, axis by axis.
    count : (n_block,)
        Samples.
    trial : (n_block,) int
        Which trial a block belongs to.
    """

    gram: Floats
    moment: Floats
    power: Floats
    count: Floats
    trial: NDArray[np.intp]

    @property
    def samples(self) -> int:
        """Number of samples in all blocks."""
        return int(self.count.sum())

    def __add__(self, other: "TipSums") -> "TipSums":
        """Return the sums of both; blocks of a trial that is in both follow one another."""
        return add_up([self, other])

    def total(self) -> "TipSums":
        """Return the same sums as one block."""
        whole = {name: getattr(self, name).sum(axis=0, keepdims=True) for name in _SUMS}
        return TipSums(**whole, trial=np.zeros(1, dtype=np.intp))

    def whitened(self) -> Whitened:
        """Return the cost of a coefficient matrix C as ``|W C^T - z|^2 + rest``."""
        return whiten(self.gram.sum(axis=0), self.moment.sum(axis=0), self.power.sum(axis=0))

    def thinned(self) -> "TipSums":
        """Return the same sums in fewer blocks, neighbours of one trial joined in pairs, if there are many."""
        room = _BLOCK_BYTES // (8 * self.gram.shape[1] ** 2)
        if len(self.trial) <= max(2, min(_ALL_BLOCKS, room)):
            return self
        place = np.arange(len(self.trial)) - np.searchsorted(self.trial, self.trial)
        starts = np.flatnonzero(place % 2 == 0)
        joined = {name: np.add.reduceat(getattr(self, name), starts, axis=0) for name in _SUMS}
        return TipSums(**joined, trial=self.trial[starts])


_SUMS = tuple(field.name for field in fields(TipSums) if field.name != "trial")


def add_up(parts: Sequence[TipSums]) -> TipSums:
    """Return the blocks of several sums, trial by trial.

    Raises
    ------
    ValueError
        If there are no parts.
    """
    trial = np.concatenate([part.trial for part in parts])
    order = np.argsort(trial, kind="stable")
    joined = {name: np.concatenate([getattr(part, name) for part in parts])[order] for name in _SUMS}
    return TipSums(**joined, trial=trial[order])


def tip_sums(
    arm: Arm,
    q: Floats,
    displacement: Floats,
    rest: Floats | None = None,
    trial: int = 0,
    blocks: int = _BLOCKS,
    angle_noise: Floats | None = None,
) -> TipSums:
    """Reduce a stretch of one trial to its sums.

    Parameters
    ----------
    arm : Arm
        Which joints turn and which slide.
    q : (n_sample, n_joint) [rad or m]
    displacement : (n_sample, 3) [m]
        Of the tip, from where it was at the rest.
    rest : (n_joint,) or (n_sample, n_joint), optional
        Joint angles at the rest, or of samples of it. Without it, angles and tip are compared with their
        means over the stretch: right for independent measurements, not for dead reckoning.
    trial : int
        Number of the trial.
    blocks : int
        How many blocks to part the stretch into, at most.
    angle_noise : (n_joint,) [rad or m], optional
        Standard deviation of white Gaussian noise in ``q``: the sums are then those that angles without it
        would have, in expectation. They may fail to be sums of any angles, see
        `fitter.kinematics.reliable.reliable`.

    Returns
    -------
    TipSums

    Raises
    ------
    DataError
        If the shapes don't fit.
    """
    angles, tip = joint_rows(arm, "q", q), np.atleast_2d(np.asarray(displacement, dtype=float))
    if tip.shape != (len(angles), 3):
        raise DataError(f"tip has shape {tip.shape}, expected ({len(angles)}, 3) to go with q")
    revolute = turning(arm)
    if angle_noise is not None and np.any(angle_noise > 0.0):
        at_rest = None if rest is None else joint_rows(arm, "rest", rest)
        return _corrected(revolute, angles, tip, at_rest, trial, blocks, np.square(angle_noise))
    if rest is None:
        origin = _mean_basis(revolute, angles)
        tip = tip - tip.mean(axis=0)
    else:
        origin = _mean_basis(revolute, joint_rows(arm, "rest", rest))
    return _summed(revolute, angles, tip, origin[1:], trial, blocks)


def _corrected(
    revolute: tuple[bool, ...],
    q: Floats,
    tip: Floats,
    rest: Floats | None,
    trial: int,
    blocks: int,
    variance: Floats,
) -> TipSums:
    """Return the sums with the noise of the angles undone, and only then counted from the origin."""
    factor = basis_factor(revolute, variance)
    tip = tip - tip.mean(axis=0) if rest is None else tip
    sums = _summed(revolute, q, tip, np.zeros(len(factor)), trial, blocks)
    gram, moment = undone_gram(revolute, sums.gram, variance), factor[:, None] * sums.moment
    if rest is None:
        there, clean, n_origin = sums.gram.sum(axis=0), gram.sum(axis=0), len(q)
    else:
        there = _summed(revolute, rest, np.zeros((len(rest), 3)), np.zeros(len(factor)), trial, 1).gram[0]
        clean, n_origin = undone_gram(revolute, there[None], variance)[0], len(rest)
    origin = clean[0] / n_origin
    # The origin's own noise, squared, counts once too often where it is foreign, and is lacking in a mean.
    own = (factor[:, None] * there * factor - clean) / n_origin**2
    about = np.outer(origin, origin) + (own if rest is None else -own)
    cross = gram[:, :, :1] * origin
    gram = gram - cross - np.swapaxes(cross, 1, 2) + sums.count[:, None, None] * about
    moment = moment - origin[:, None] * moment[:, :1]
    return TipSums(gram[:, 1:, 1:], moment[:, 1:], sums.power, sums.count, sums.trial)


def _summed(
    revolute: tuple[bool, ...], q: Floats, tip: Floats, origin: Floats, trial: int, blocks: int
) -> TipSums:
    """Return the sums of as many of the basis functions, from the last, as the origin has, less the origin."""
    sums = _zeros(len(origin), max(1, min(blocks, _BLOCKS, len(q))), trial)
    ends = np.linspace(0, len(q), len(sums.trial) + 1).astype(np.intp)
    for block in range(len(sums.trial)):
        for start in range(ends[block], ends[block + 1], _CHUNK):
            part = slice(start, min(start + _CHUNK, ends[block + 1]))
            phi = basis(revolute, q[part])[:, -len(origin) :] - origin
            sums.gram[block] += phi.T @ phi
            sums.moment[block] += phi.T @ tip[part]
            sums.power[block] += np.einsum("ki,ki->i", tip[part], tip[part])
            sums.count[block] += len(phi)
    return sums


def no_sums(arm: Arm) -> TipSums:
    """Return the sums of no samples."""
    return _zeros(basis(turning(arm), np.zeros((1, arm.n_joint))).shape[1] - 1, 1, 0)


def _zeros(n_basis: int, blocks: int, trial: int) -> TipSums:
    n_block = max(1, min(blocks, _BLOCK_BYTES // (8 * n_basis**2)))
    return TipSums(
        np.zeros((n_block, n_basis, n_basis)),
        np.zeros((n_block, n_basis, 3)),
        np.zeros((n_block, 3)),
        np.zeros(n_block),
        np.full(n_block, trial, dtype=np.intp),
    )


def _mean_basis(revolute: Sequence[bool], q: Floats) -> Floats:
    chunks = (basis(revolute, q[start : start + _CHUNK]).sum(axis=0) for start in range(0, len(q), _CHUNK))
    return np.asarray(sum(chunks) / len(q), dtype=np.float64)
