"""What one recording says of every marker's place: its error against the others, on average and by seconds.

Skin wanders slowly, so frames of one second count as one: the scatter of means comes from such blocks.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marked_arm import marked_arm
from fitter.limb.solved_motion import SolvedMotion, solve_motion
from fitter.marker_diagnosis.left_out import LeftOut, left_out
from protocol.markers.recording import MarkerRecording

#: Frames of so long count as one: skin and gait repeat about once a second (a convention) [s].
BLOCK_S = 1.0
#: Information below this share of a marker's own says nothing of where it should be: of three markers on a last
#: link each is where the other two allow.
_TELLING = 1e-3


@dataclass(frozen=True)
class TrialErrors:
    """One recording's markers, each against the motion that the others show.

    Attributes
    ----------
    names : tuple of str
        As the arm has them, whatever their labels are in this recording.
    std_m : (m,)
        How far each may wander, by the arm.
    link : (m,) int
        Which joint moves it, from 0; -1 for the base.
    out : LeftOut
    q : (n_frame, n_joint)
    y : (n_frame, m, 3) [m]
        As measured.
    block : (n_frame,) int
    mean : (m, 3) [m]
        In the link's axes; NaN where nothing tells.
    block_means : (n_block, m, 3) [m]
        The same of every block.
    squares : (n_block, m) [m²]
        Squared distances from the motion of all markers, summed up.
    """

    names: tuple[str, ...]
    std_m: Floats
    link: NDArray[np.int64]
    out: LeftOut
    q: Floats
    y: Floats
    block: NDArray[np.int64]
    mean: Floats
    block_means: Floats
    squares: Floats

    @property
    def n_block(self) -> int:
        """Number of blocks."""
        return int(self.block[-1]) + 1

    def mean_of(self, errors: Mapping[int, Floats]) -> dict[int, Floats]:
        """Return weighted means (3,) of other errors (n_frame, 3) of some markers, NaN where there are none."""
        return {m: _mean(error, self.out.information[:, m]) for m, error in errors.items()}


def trial_errors(arm: Arm, recording: MarkerRecording, trial: int) -> TrialErrors:
    """Track a recording and return its markers' errors.

    Parameters
    ----------
    arm : Arm
        With its effects.
    recording : MarkerRecording
    trial : int
        Its number, from 1.
    """
    solved = solve_motion(arm, recording, trial)
    marked, frames, chain = solved.marked, solved.frames, solved.chain
    std = marked.everything.std
    out = left_out(chain, frames, std, marked.angles, solved.smoothed.q)
    own = np.trace(out.information, axis1=2, axis2=3) * std**2 / 3.0
    out.information[own < _TELLING] = 0.0
    block = ((frames.t - frames.t[0]) / BLOCK_S).astype(np.int64)
    mean = np.array([_mean(out.error[:, m], out.information[:, m]) for m in range(len(std))])
    blocks = [block == b for b in range(int(block[-1]) + 1)]
    block_means = np.array(
        [[_mean(out.error[b, m], out.information[b, m]) for m in range(len(std))] for b in blocks]
    )
    return TrialErrors(
        marked_arm(replace(arm, effects=())).names,
        std,
        np.asarray(chain.link) - marked.markers.sway,
        out,
        solved.smoothed.q[:, marked.markers.sway :],
        frames.y,
        block,
        mean,
        block_means,
        _squares(solved, block),
    )


def _squares(solved: SolvedMotion, block: NDArray[np.int64]) -> Floats:
    """Return squared distances of markers from the motion, block by block."""
    off = np.nansum((solved.frames.y - predicted(solved.chain, solved.frames, solved.smoothed.q)) ** 2, axis=2)
    sums = np.zeros((int(block[-1]) + 1, off.shape[1]))
    np.add.at(sums, block, off)
    return sums


def _mean(error: Floats, information: Floats) -> Floats:
    total = information.sum(axis=0)
    if not np.trace(total) > 0.0:
        return np.full(3, np.nan)
    return np.linalg.solve(total, np.einsum("nij,nj->i", information, np.nan_to_num(error)))
