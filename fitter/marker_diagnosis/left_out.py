"""Errors of markers against the motion that all others show: leave-one-out residuals, frame by frame.

A frame's angles have the information ``A`` with every marker's slopes ``J`` and weight ``w``. A marker that is
left out has the error ``(I - w P)^-1 r``, with its residual ``r`` and ``P = J A^-1 J^T``; the others predict it
with the covariance ``P (I - w P)^-1`` (Cook and Weisberg 1982, Residuals and Influence in Regression, 2.2).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.marker_kinematics import MarkerChain, Slopes, joint_slopes, link_frames, marker_at, slopes_room
from arm.model import Floats
from fitter.limb.marker_observations import AnglePrior, Frames
from fitter.limb.normal_equations import t_weight
from limbcal.compiled import compiled


@dataclass(frozen=True)
class LeftOut:
    """Errors of one recording's markers, each against the motion that the others show.

    Attributes
    ----------
    error : (n_frame, m, 3) [m]
        In the axes of the marker's link, NaN where it was not seen.
    information : (n_frame, m, 3, 3) [1/m²]
        Of each error: the inverse of the marker's own variance and that of its prediction. Zero where it was not
        seen, or where without it nothing tells where it should be.
    place : (n_frame, m, 3) [m]
        Where the others have the marker, in the world.
    axes : (n_frame, m, 3, 3)
        The link's axes as columns, in the world.
    """

    error: Floats
    information: Floats
    place: Floats
    axes: Floats


def left_out(chain: MarkerChain, frames: Frames, std_m: Floats, prior: AnglePrior, q: Floats) -> LeftOut:
    """Return every marker's error against the others.

    Parameters
    ----------
    chain : MarkerChain
    frames : Frames
    std_m : (m,)
    prior : AnglePrior
    q : (n_frame, n)
        The angles that fit all markers.
    """
    n_frame, m, _ = frames.y.shape
    error, place = np.full((n_frame, m, 3), np.nan), np.full((n_frame, m, 3), np.nan)
    information, axes = np.zeros((n_frame, m, 3, 3)), np.zeros((n_frame, m, 3, 3))
    room = slopes_room(q.shape[1], 0)
    _left_out(chain, frames, std_m**2, prior, np.ascontiguousarray(q), room, error, information, place, axes)
    return LeftOut(error, information, place, axes)


@compiled
def _left_out(
    chain: MarkerChain,
    frames: Frames,
    variance: Floats,
    prior: AnglePrior,
    q: Floats,
    room: Slopes,
    error: Floats,
    information: Floats,
    place: Floats,
    axes: Floats,
) -> None:
    n_frame, n = q.shape
    n_marker = chain.link.size
    A, y = np.empty((n, n)), np.empty(3)
    J, r, w = np.empty((n_marker, 3, n)), np.empty((n_marker, 3)), np.empty(n_marker)
    for k in range(n_frame):
        link_frames(chain, frames.R[k], frames.p[k], q[k], room)
        A[:] = 0.0
        for i in range(n):
            A[i, i] = prior.information[i]
        for m in range(n_marker):
            R = room.R[chain.link[m]]
            axes[k, m] = R
            marker_at(chain, room, m, y)
            place[k, m] = y
            w[m] = 0.0
            if np.isnan(frames.y[k, m, 0]):
                continue
            r[m] = frames.y[k, m] - y
            w[m] = t_weight(r[m, 0] ** 2 + r[m, 1] ** 2 + r[m, 2] ** 2, variance[m])
            joint_slopes(chain, room, m, y)
            J[m] = room.by_q
            for i in range(n):
                for j in range(n):
                    for row in range(3):
                        A[i, j] += w[m] * J[m, row, i] * J[m, row, j]
        inverse = np.linalg.inv(A)
        for m in range(n_marker):
            if w[m] == 0.0:
                continue
            R = np.ascontiguousarray(axes[k, m])
            P = J[m] @ inverse @ np.ascontiguousarray(J[m].T)
            kept = np.eye(3) - w[m] * P
            lean = np.linalg.inv(kept + 1e-9 * np.eye(3))
            off = lean @ r[m]
            covariance = P @ lean + variance[m] * np.eye(3)
            covariance = 0.5 * (covariance + covariance.T)
            back = np.ascontiguousarray(R.T)
            error[k, m] = back @ off
            information[k, m] = back @ np.linalg.inv(covariance) @ R
            place[k, m] = frames.y[k, m] - off


def is_seen(frames: Frames) -> NDArray[np.bool_]:
    """Return where markers were seen, (n_frame, m)."""
    return np.isfinite(frames.y[..., 0])
