"""Drives that let less noise through than they are asked for: a limit, by how much of the torque it cuts off."""

from collections.abc import Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View

#: A torque that another differs from by this share of its rms is cut off.
_CUT = 0.01
_LIMIT = "torque_saturation"


def cuts_off(model: Model) -> bool:
    """Say whether a drive of a model has a limit."""
    return any(hypothesis.kind.name == _LIMIT for hypothesis in model.hypotheses)


def distorts(model: Model) -> bool:
    """Say whether a drive of a model is late, weak or unequal: what noise it lets through is to be computed."""
    return any(map(_distorts, model.hypotheses))


def undistorted(model: Model) -> Model:
    """Return a model without such drives."""
    return model.only([not _distorts(hypothesis) for hypothesis in model.hypotheses])


def _distorts(hypothesis: Hypothesis) -> bool:
    return hypothesis.kind.place == "drive" and hypothesis.kind.name != _LIMIT


def let_through(views: Sequence[View], motions: Sequence[Motion]) -> Floats:
    """Return the share of each joint's torque squared that a limit lets through, (n_joint,).

    It counts as far as the limit is reached: of a torque that is cut off now and then nearly all noise stays.

    Parameters
    ----------
    views : sequence of View
        Motions as they are under the limit.
    motions : sequence of Motion
        The same as measured.
    """
    asked, reaches, cut, moving = np.zeros((4, motions[0].u.shape[1]))
    for view, motion in zip(views, motions, strict=True):
        moves = ~motion.stuck
        asked += np.sum(motion.u**2 * moves, axis=0)
        reaches += np.sum(view.u**2 * moves, axis=0)
        off = np.abs(view.u - motion.u) > _CUT * np.sqrt(np.mean(motion.u**2, axis=0))
        cut += np.sum(off & moves, axis=0)
        moving += np.sum(moves, axis=0)
    through = np.clip(reaches / np.maximum(asked, 1e-300), 1e-12, 1.0)
    return np.asarray(through ** (cut / np.maximum(moving, 1.0)), dtype=np.float64)
