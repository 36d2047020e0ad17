"""Motions of a tracker estimated again when they have ended, each from all of its readings at once.

A tracker says at every instant what it knows then. Once the arm rests again more is known of the motion before:
the smoother goes over its readings from rest to rest, and says how well it is known then.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from arm.model import Arm
from fitter.data.leaps import MINIMUM_SAMPLES
from fitter.data.motions import Measured
from fitter.data.recordings import read_frames
from fitter.data.uncertain_motion import UNCERTAIN, with_uncertain_marked
from limbcal.errors import LimbcalError
from limbcal.note import Note
from tracking.smoother.motion_follower import MotionFollower

#: What was said of the tracker's own frames, and is not so of those found again.
_OF_TRACKER = ("drift", UNCERTAIN)


def follower_of(arm: Arm, seed: int = 0) -> MotionFollower:
    """Return what estimates an arm's motions again, one after the other.

    Parameters
    ----------
    arm : Arm
    seed : int
        Of the draws of what is wrong with a motion.
    """
    return MotionFollower(arm, seed, () if arm.tip is None else (arm.sensor_index(arm.tip.sensor),))


def recorded_motions(files: Sequence[Path], arm: Arm, as_tracked: bool = False) -> list[Measured]:
    """Read the motions of the recordings of one run, see `fitter.data.recordings`.

    Parameters
    ----------
    files : sequence of Path
    arm : Arm
    as_tracked : bool
        Leave them as the tracker gave them out, instead of estimating each again.

    Raises
    ------
    DataError
        If there are no frames in them or they are of another arm.
    """
    follower, motions = follower_of(arm), read_frames(files, arm.n_joint)
    return motions if as_tracked else [estimated_again(follower, motion) for motion in motions]


def estimated_again(follower: MotionFollower, motion: Measured) -> Measured:
    """Return a motion as the smoother finds it, from the last instant of rest before it, with draws of its errors.

    Parameters
    ----------
    follower : MotionFollower
        Has followed the motions before it.
    motion : Measured
        As the tracker gave it out; unchanged where its readings did not come along, and, but for a note, where no
        motion of the arm explains them.
    """
    felt = motion.felt
    if felt is None:
        return motion
    try:
        known = follower.follow(felt.readings, felt.q, felt.q_std, felt.end_q)
    except LimbcalError as error:
        return _as_tracked(motion, str(error))
    rests = np.flatnonzero(known.still & (felt.t_s <= motion.t[0]))
    begin, end = int(rests[-1]) if len(rests) else 0, int(np.searchsorted(felt.t_s, motion.t[-1], side="right"))
    # Where the arm is held to be at rest paths stand still, though it may still creep.
    moves = begin + np.flatnonzero(~known.still[begin:end])
    rows = slice(begin, int(moves[-1]) + 1 if len(moves) else begin)
    if rows.stop - rows.start < MINIMUM_SAMPLES:
        return _as_tracked(motion, f"it has {rows.stop - rows.start} instants from rest to rest")
    columns = {name: getattr(known, name)[rows] for name in ("q", "dq", "ddq", "points")}
    said = Note("estimated", "estimated again from its readings, all of them at once from rest to rest")
    notes = (*(note for note in motion.notes if note.kind not in _OF_TRACKER), said)
    draws = known.draws.rows(rows)
    found = replace(motion, t=felt.t_s[rows], columns=columns, notes=notes, felt=None, draws=draws)
    lost = np.any(np.isnan(felt.readings.values[rows]), axis=1)
    claims = {name: np.std(getattr(draws, name), axis=0) for name in ("q", "dq", "ddq")}
    return with_uncertain_marked(found, lost, claims)


def _as_tracked(motion: Measured, why: str) -> Measured:
    note = Note("tracked", f"not estimated again from its readings ({why}): taken as it was tracked")
    return replace(motion, notes=(*motion.notes, note), felt=None)
