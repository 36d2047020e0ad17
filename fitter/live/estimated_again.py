"""A motion estimated again when it has ended, from all of its readings at once."""

from dataclasses import replace

import numpy as np

from fitter.data.felt import Felt
from fitter.data.motions import Measured
from tracking.model.draws import Draws
from tracking.smoother.motion_follower import MotionFollower


def estimated_again(follower: MotionFollower, motion: Measured, felt: Felt) -> tuple[Measured, Draws]:
    """Return a motion as the smoother finds it, from the last instant of rest before it, and draws of it.

    Parameters
    ----------
    follower : MotionFollower
        Has followed the motions before it.
    motion : Measured
        As the tracker gave it out live.
    felt : Felt
        What the sensors read.

    Raises
    ------
    DataError
        If no motion of the arm explains the readings.
    """
    known = follower.follow(felt.readings, felt.q, felt.q_std, felt.end_q)
    rests = np.flatnonzero(known.still & (felt.t_s <= motion.t[0]))
    begin, end = int(rests[-1]) if len(rests) else 0, int(np.searchsorted(felt.t_s, motion.t[-1], side="right"))
    # Where the arm is held to be at rest paths stand still, though it may still creep.
    rows = slice(begin, int(np.flatnonzero(~known.still[:end])[-1]) + 1)
    columns = {name: getattr(known, name)[rows] for name in ("q", "dq", "ddq", "points")}
    return replace(motion, t=felt.t_s[rows], columns=columns), known.draws.rows(rows)
