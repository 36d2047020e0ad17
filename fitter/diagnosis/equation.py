"""The equation of motion of a whole run, weighted so that its noise is white (`whitening`).

While a joint is stuck its friction is not known, and a torque that jumps does so between two samples: unknown
torques j there, of a few shapes each (`whitening`) and of known variance, make the noise's covariance
``I + sum j j^T``, so with the singular values s of all of them, equations count ``1 / sqrt(1 + s^2)`` times along
each of their axes. Those of any size are eliminated from both sides, which costs what they could have told and
leaves the noise of everything else white.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.fft
import scipy.linalg

from arm.model import Arm, Floats
from fitter.diagnosis.least_squares import NEGLIGIBLE, ROUNDED
from fitter.diagnosis.motion import SAMPLES, Motion, noise_of_angles, white_noise
from fitter.diagnosis.whitening import Whitening, end_shapes, holding_shapes, jump_shapes, rest_shapes
from fitter.side_by_side import side_by_side

#: The band ends at this share of the columns' corner, where their filter still lets all through.
BAND_SHARE = 0.6
#: A perfect torque or angle has at least the noise of rounding, as a share of its rms.
_LEAST_NOISE = 1e-4


@dataclass(frozen=True)
class Weighting(Whitening):
    """The filter that makes the noise of a run white, and takes out what may hold a joint.

    Attributes
    ----------
    holding : mapping of int to (n_sample, n_joint) [N m or N]
        Standard deviation of what may hold each joint, by the motions' numbers; inf, or no entry, where nothing
        tells.
    """

    holding: Mapping[int, Floats]
    _held: dict[int, tuple[Floats, Floats]] = field(default_factory=dict, init=False, repr=False)
    _told: dict[int, Floats] = field(default_factory=dict, init=False, repr=False)

    def filtered(self, motion: Motion, rows: Floats) -> Floats:
        """Return rows (n_sample, n_joint, …), filtered and on the slower grid, without what may hold a joint."""
        white = self.whitened(motion, rows)
        return self.freed(motion, white.reshape(white.shape[0] * white.shape[1], -1)).reshape(white.shape)

    def filtered_at(self, motion: Motion, joint: int, torques: Floats) -> Floats:
        """Return the same of torques (n_sample, n_column) at one joint, (n_slower * n_joint, n_column)."""
        return self.freed(motion, self.whitened_at(motion, joint, torques))

    def whitened_at(self, motion: Motion, joint: int, torques: Floats) -> Floats:
        """Return the same with what may hold a joint."""
        white = self.white(torques[:, None], motion.dt_s, slice(joint, joint + 1))
        return white.reshape(-1, torques.shape[1])

    def whitened(self, motion: Motion, rows: Floats) -> Floats:
        """Return rows (n_sample, n_joint, …), filtered and on the slower grid, with what may hold a joint."""
        acts = np.flatnonzero(np.any(rows.reshape(*rows.shape[:2], -1), axis=(0, 2)))
        only = slice(acts[0], acts[0] + 1) if len(acts) == 1 else slice(None)
        return self.white(rows[:, only], motion.dt_s, only)

    def freed(self, motion: Motion, flat: Floats, held: Floats | None = None) -> Floats:
        """Return white rows (n_slower * n_joint, n_column) without what may hold a joint.

        Parameters
        ----------
        motion : Motion
        flat : (n_slower * n_joint, n_column)
        held : (n_axis, n_column), optional
            The same along `axes`, where it is known.
        """
        axes, lost = self.axes(motion)
        along = self.along(motion, flat) if held is None else held
        # Of several columns the same product the other way round takes twice as long.
        return np.asarray(flat - ((lost[:, None] * along).T @ axes.T).T, dtype=np.float64)

    def along(self, motion: Motion, flat: Floats) -> Floats:
        """Return white rows (n_slower * n_joint, n_column) along `axes`, (n_axis, n_column)."""
        # The other way round the same product takes a quarter longer: few columns are read in a row.
        return np.asarray((flat.T @ self.axes(motion)[0]).T, dtype=np.float64)

    def prepare(self, motions: Sequence[Motion]) -> None:
        """Work out what may hold the joints in all motions, and what they tell, with all processors."""
        unknown = [motion for motion in motions if motion.number not in self._told]
        found = side_by_side(lambda motion: (self.axes(motion), self.told_at_joints(motion)), unknown)
        for motion, (axes, told) in zip(unknown, found, strict=True):
            self._held[motion.number], self._told[motion.number] = axes, told

    def told(self, motion: Motion) -> float:
        """Return how many numbers a motion's equations tell."""
        return float(np.sum(self.told_at_joints(motion)))

    def told_at_joints(self, motion: Motion) -> Floats:
        """Return the same joint by joint, (n_joint,): what is eliminated counts where it would have been seen."""
        if motion.number not in self._told:
            axes, lost = self.axes(motion)
            rows = axes.reshape(-1, motion.q.shape[1], axes.shape[1])
            size = scipy.fft.next_fast_len(2 * len(rows), real=True)
            band = self.band(scipy.fft.rfftfreq(size, self.stride * motion.dt_s))
            # The noise is band-limited, so an axis beside the band has next to none of it to lose.
            seen = scipy.fft.irfft(band[:, None, None] * scipy.fft.rfft(rows, size, axis=0), size, axis=0)
            gone = np.sum(seen**2, axis=0) @ (1.0 - (1.0 - lost) ** 2)
            self._told[motion.number] = self.n_told(len(rows), motion.dt_s) - gone
        return self._told[motion.number]

    def axes(self, motion: Motion) -> tuple[Floats, Floats]:
        """Return orthonormal axes of what is not known of the torque, filtered, and how much of each is lost."""
        if motion.number not in self._held:
            anyhow, roughly = self._unknown(motion)
            held = _orthonormal(anyhow)
            U, size = _singular(roughly - held @ (held.T @ roughly))
            lost = np.concatenate([np.ones(held.shape[1]), 1.0 - 1.0 / np.sqrt(1.0 + size**2)])
            # In this order their products with few columns take three quarters of the time.
            self._held[motion.number] = np.asfortranarray(np.hstack([held, U])), lost
        return self._held[motion.number]

    def _unknown(self, motion: Motion) -> tuple[Floats, Floats]:
        """Return torques that may have any size, and those of one standard deviation, filtered, one a column."""
        n, n_joint = motion.q.shape
        ends = end_shapes(n, motion.dt_s)
        anyhow = [_at(j, ends, n_joint) for j in range(n_joint)]
        roughly = [jump_shapes(motion.jumps, n, n_joint)]
        holding = self.holding.get(motion.number, np.full(motion.q.shape, np.inf))
        for j, size in enumerate(holding.T):
            shapes = holding_shapes(motion.stuck[:, j], motion.dt_s)
            if np.all(np.isfinite(size)):
                roughly.append(_at(j, size[:, None] * shapes, n_joint))
                shapes = rest_shapes(motion.stuck[:, j], motion.dt_s)
            anyhow.append(_at(j, shapes, n_joint))
        white = (self.white(np.concatenate(part, axis=2), motion.dt_s) for part in (anyhow, roughly))
        first, second = (rows.reshape(rows.shape[0] * n_joint, rows.shape[2]) for rows in white)
        return first, second


def _at(joint: int, torques: Floats, n_joint: int) -> Floats:
    """Return torques (n_sample, n_torque) at one joint as rows of all of them, (n_sample, n_joint, n_torque)."""
    rows = np.zeros((len(torques), n_joint, torques.shape[1]))
    rows[:, joint] = torques
    return rows


def _orthonormal(columns: Floats) -> Floats:
    """Return an orthonormal basis of what columns span."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(size > 0.0, size, 1.0)  # a rest of one sample makes nothing of one of its hats
    Q, R, _ = scipy.linalg.qr(scaled, mode="economic", pivoting=True, check_finite=False)
    size = np.abs(np.diag(R))
    return np.ascontiguousarray(Q[:, : len(size)][:, size > np.sqrt(ROUNDED) * size[0]])


def _singular(columns: Floats) -> tuple[Floats, Floats]:
    """Return the left singular vectors of columns and their values, but for those that noise drowns.

    By the columns' products: exact enough for what is not, in half the time.
    """
    squared, axes = scipy.linalg.eigh(columns.T @ columns, check_finite=False)
    kept = squared > max(NEGLIGIBLE**2, ROUNDED * float(squared.max(initial=0.0)))
    size = np.sqrt(squared[kept])
    return columns @ (axes[:, kept] / size), size


def weighting(arm: Arm, motions: Sequence[Motion]) -> Weighting:
    """Return the filter for a run of which no more is known: every joint turns a mass of one by itself.

    Parameters
    ----------
    arm : Arm
        Its law says how the noise of the angles enters a torque that was not measured.
    motions : sequence of Motion
    """
    angle = noise_of_angles([motion.trial for motion in motions])
    u = np.concatenate([motion.u for motion in motions])
    if all("tau" in motion.trial.whole for motion in motions):
        torque = white_noise([motion.trial.whole["tau"] for motion in motions])
    elif arm.control.kp and motions[0].trial.tau is None:
        torque = np.abs(arm.control.kp) * angle
    else:
        torque = np.zeros(arm.n_joint)
    # What counts is the noise's density; the slower grid has the same with fewer samples.
    thinned = np.sqrt(np.mean([motion.trial.dt_s / motion.dt_s for motion in motions]))
    torque, angle = thinned * torque, thinned * angle
    torque = np.maximum(torque, _LEAST_NOISE * np.maximum(np.sqrt(np.mean(u**2, axis=0)), 1e-9))
    q = np.concatenate([motion.q for motion in motions])
    angle = np.maximum(angle, 1e-9 * np.maximum(np.std(q, axis=0), 1.0))
    acceleration = np.diag(angle**2)
    dt_s = max(motion.dt_s for motion in motions)
    corner = min(*(motion.trial.cutoff_hz for motion in motions), 0.4 / dt_s)
    band = BAND_SHARE * corner
    return Weighting(torque, acceleration, band, max(1, int(1.0 / (dt_s * 0.5 * SAMPLES * band))), {})
