"""What a torque fit needs of the data: sums of products, so few that a billion samples cost what a thousand do.

The torque is linear in the base parameters, ``tau = W p`` (eq. (4), (8)), so the cost of eq. (9) depends on
the data only through ``W^T W``, ``W^T tau`` and ``tau^T tau``. They are kept for every joint and for short
blocks of consecutive samples: added up they give the cost, side by side the scatter of the answer.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.chain import chain_of, joint_rows
from arm.model import Arm, Floats
from fitter.regression_sums.running_sums import RunningSums
from limbcal.errors import DataError

#: A column that varies by less than this fraction of itself within a trial is constant there.
_CONSTANT = 1e-2


@dataclass(frozen=True)
class TorqueSums:
    """Sums over blocks of consecutive samples, for every joint.

    Attributes
    ----------
    gram : (n_block, n_joint, n_base, n_base)
        W^T W.
    moment : (n_block, n_joint, n_base)
        W^T tau.
    power : (n_block, n_joint)
        tau^T tau.
    row, torque : (n_block, n_joint, n_base), (n_block, n_joint)
        Sums of W and of tau.
    count : (n_block, n_joint)
        Samples in which the joint moved.
    trial : (n_block,) int
        Which trial a block belongs to.
    samples : int
        Samples seen, moving or not.
    variance : float, optional
        Variance of every residual, where the equations were weighted so that it is one and the same and they are
        independent; None where the answer's scatter has to tell.
    """

    gram: Floats
    moment: Floats
    power: Floats
    row: Floats
    torque: Floats
    count: Floats
    trial: NDArray[np.intp]
    samples: int
    variance: float | None = None

    def __add__(self, other: "TorqueSums") -> "TorqueSums":
        """Return the sums of both, the trials of the second being other trials."""
        return add_up([self, other])

    def total(self) -> "TorqueSums":
        """Return the same sums as one block, for cost and answer; it no longer knows of trials."""
        whole = {name: getattr(self, name).sum(axis=0, keepdims=True) for name in _SUMS}
        return TorqueSums(**whole, trial=np.zeros(1, dtype=np.intp), samples=self.samples, variance=self.variance)

    def centred(self) -> "TorqueSums":
        """Return sums in which every trial and joint has a constant torque of its own that is not sought.

        Taking the trial's means off W and tau is the same as fitting one more unknown for each trial and
        joint together with the base parameters.
        """
        row, torque = self._means()
        count = self.count[..., None]
        # sums of (W - mean)(W - mean)^T, and alike for the others
        cross = self.row[..., :, None] * row[..., None, :]
        gram = self.gram - cross - np.swapaxes(cross, -1, -2)
        gram += count[..., None] * row[..., :, None] * row[..., None, :]
        moment = self.moment - self.row * torque[..., None] - row * self.torque[..., None]
        moment += count * row * torque[..., None]
        power = self.power - 2.0 * self.torque * torque + self.count * torque**2
        # A column that was constant all along, such as the sign of a velocity that never turns, is not
        # distinguished from the constants; what rounding or filtering leaves of it must not pass for information.
        squares = [np.einsum("bjaa->a", sums) for sums in (gram, self.gram)]
        varies = squares[0] > _CONSTANT**2 * squares[1]
        gram, moment = gram * np.outer(varies, varies), moment * varies
        return TorqueSums(
            gram,
            moment,
            power,
            (self.row - count * row) * varies,
            self.torque - self.count * torque,
            self.count,
            self.trial,
            self.samples,
        )

    def constants(self, values: Floats) -> Floats:
        """Return the constant torque of every trial and joint that goes with given base parameters.

        Returns
        -------
        (n_trial, n_joint)
        """
        row, torque = self._means()
        first = np.unique(self.trial, return_index=True)[1]
        return np.asarray(torque[first] - row[first] @ values, dtype=np.float64)

    def cost(self, population: Floats) -> Floats:
        """Return eq. (9) summed over samples and joints, ``sum (tau - W p)^2``, from the sums as they are.

        Good to about 1e-15 of ``tau^T tau``; `fitter.dynamics.torque_problem` has no such floor.

        Parameters
        ----------
        population : (n_individual, n_base)

        Returns
        -------
        (n_individual,) [(N m)^2]
        """
        gram, moment = self.gram.sum(axis=(0, 1)), self.moment.sum(axis=(0, 1))
        square = np.einsum("ia,ab,ib->i", population, gram, population)
        return np.asarray(square - 2.0 * population @ moment + self.power.sum(), dtype=np.float64)

    def rms(self, values: Floats) -> Floats:
        """Return what the residual torque is in the mean square, (n_joint,) [N m or N]."""
        gram, moment = self.gram.sum(axis=0), self.moment.sum(axis=0)
        square = np.einsum("a,jab,b->j", values, gram, values) - 2.0 * moment @ values + self.power.sum(axis=0)
        rms: Floats = np.sqrt(np.maximum(square, 0.0) / np.maximum(self.count.sum(axis=0), 1.0))
        return rms

    def explained(self, values: Floats) -> Floats:
        """Return 1 − power of the residual torque / power of the torque, (n_joint,); NaN where there is none."""
        power = self.power.sum(axis=0)
        residual_power = self.rms(values) ** 2 * self.count.sum(axis=0)
        return np.asarray(1.0 - residual_power / np.where(power > 0.0, power, np.nan), dtype=np.float64)

    def scores(self, values: Floats) -> Floats:
        """Return W^T (tau - W p) of every block, all joints together, (n_block, n_base)."""
        return np.asarray((self.moment - self.gram @ values).sum(axis=1), dtype=np.float64)

    def _means(self) -> tuple[Floats, Floats]:
        """Return the mean W and tau of the trial that each block belongs to."""
        index = np.unique(self.trial, return_inverse=True)[1]
        sums = []
        for values in (self.count, self.torque, self.row):
            whole = np.zeros((int(index.max(initial=-1)) + 1, *values.shape[1:]))
            np.add.at(whole, index, values)
            sums.append(whole)
        count = np.maximum(sums[0], 1.0)
        return (sums[2] / count[..., None])[index], (sums[1] / count)[index]


_SUMS = tuple(field.name for field in fields(TorqueSums) if field.name not in ("trial", "samples", "variance"))


def add_up(parts: Sequence[TorqueSums]) -> TorqueSums:
    """Return the sums of several sets of trials, each part's trials being different from the others'.

    Raises
    ------
    ValueError
        If there are no parts.
    """
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _SUMS}
    trials, start = [], 0
    for part in parts:
        trials.append(part.trial + start)
        start += int(part.trial.max(initial=-1)) + 1
    samples = sum(part.samples for part in parts)
    return TorqueSums(**joined, trial=np.concatenate(trials), samples=samples, variance=None)


def torque_sums(
    arm: Arm,
    base: BaseParameters,
    q: Floats,
    dq: Floats,
    ddq: Floats,
    tau: Floats,
    rest_speed: float = 0.0,
) -> TorqueSums:
    """Reduce one trial to its sums, in one pass.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity.
    base : BaseParameters
    q, dq, ddq, tau : (n_sample, n_joint) [rad or m, derivatives, N m or N]
    rest_speed : float
        A joint no faster than this is at rest. What holds it there is friction of any size up to its static
        limit, so its torque says nothing then and is omitted.

    Returns
    -------
    TorqueSums
        One trial.

    Raises
    ------
    DataError
        If the shapes don't fit.
    """
    q, dq, ddq, tau = (joint_rows(arm, *item) for item in (("q", q), ("dq", dq), ("ddq", ddq), ("tau", tau)))
    lengths = {len(array) for array in (q, dq, ddq, tau)}
    if len(lengths) != 1:
        raise DataError(f"q, dq, ddq and tau have {sorted(lengths)} samples, expected as many of each")
    running = RunningSums(arm.n_joint, len(base.independent), len(q))
    running.add_motion(chain_of(arm), np.array(base.independent), q, dq, ddq, tau, rest_speed)
    return finished(running)


def row_sums(rows: Floats, tau: Floats, moving: NDArray[np.bool_]) -> TorqueSums:
    """Reduce equations ``rows . p = tau`` that are already there, filtered for instance, to their sums.

    Parameters
    ----------
    rows : (n_sample, n_joint, n_base)
    tau : (n_sample, n_joint) [N m or N]
    moving : (n_sample, n_joint) bool
        Which equations count.

    Returns
    -------
    TorqueSums
        One trial.
    """
    running = RunningSums(rows.shape[1], rows.shape[2], len(rows))
    running.add_equations(rows, tau, moving)
    return finished(running)


def finished(running: RunningSums) -> TorqueSums:
    """Return the sums of a trial that was read in portions."""
    arrays = dict(zip(_SUMS, running.arrays(), strict=True))
    trial = np.zeros(len(arrays["count"]), dtype=np.intp)
    return TorqueSums(**arrays, trial=trial, samples=running.samples, variance=None)
