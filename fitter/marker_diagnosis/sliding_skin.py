"""Skin that slides under a marker as a joint turns, distinguished from a limb whose axes are off.

A marker's error against the others goes with a joint's angle in both cases. An axis or length that is off takes
all markers of a link along as one rigid body; skin takes one of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from arm.model import Effect, Floats
from fitter.limb.free_geometry import TWIST_RAD
from fitter.marker_diagnosis.suspicion import Suspicion, known_in, log_normal
from fitter.marker_diagnosis.trial_errors import TrialErrors

#: By how much skin takes a marker with it: 10 to 30 mm at the thigh while hip and knee turn by about a radian
#: (Leardini et al. 2005) [m/rad].
_SLID_M_RAD = 0.02
#: How far a link goes astray as a joint turns, for the limb's own axes and lengths are another person's by so much
#: [m/rad], [rad/rad]: `fitter.limb.free_geometry` has how they differ over people, at a lever of two decimetres.
_ASTRAY_M_RAD, _ASTRAY_RAD_RAD = 0.03, TWIST_RAD
#: Joints farther along the chain than this move other skin (a ball joint has three).
_NEAR = 3
#: Joints that turn by less, rms, slide no skin that could be seen [rad].
_LEAST_TURN = 0.05
#: Blocks that a slope needs: twice its three numbers.
_LEAST_BLOCKS = 6


@dataclass(frozen=True, eq=False)
class Slide:
    """How a marker's error goes with a joint, within trials."""

    m: int
    joint: int
    slope: Floats
    covariance: Floats
    turn: float
    std_m: float

    @property
    def amplitude(self) -> Floats:
        """By how much it slides with the joint's rms turn, (3,) [m]."""
        return self.slope * self.turn

    @property
    def spread(self) -> Floats:
        """Covariance of `amplitude`, (3, 3)."""
        return self.covariance * self.turn**2

    def null(self, share: float) -> Floats:
        """Return the covariance of a sound marker's amplitude, (3, 3) [m²]."""
        return np.asarray(self.spread + (share * self.std_m) ** 2 * np.eye(3))

    def suspicion(self, trials: Sequence[TrialErrors], null: Floats, evidence: float) -> Suspicion:
        """Return it as a hypothesis."""
        known = known_in(trials, self.m)
        at = [float(np.mean(trials[r].q[:, self.joint])) for r in known]
        lag = [float(self.slope @ trials[r].mean[self.m]) / float(self.slope @ self.slope) for r in known]
        rest = float(np.mean(np.subtract(at, lag)))
        names = ("x_m_rad", "y_m_rad", "z_m_rad")
        parameters: dict[str, object] = dict(zip(names, self.slope.tolist(), strict=True))
        more = null / self.turn**2
        std = dict(zip(names, np.sqrt(np.diag(more)).tolist(), strict=True))
        parameters |= {"rest_rad": rest, "joint": self.joint + 1}
        effect = Effect("soft_tissue", parameters, markers=(trials[0].names[self.m],))
        return Suspicion(effect, std, evidence, tuple(r + 1 for r in known))


def slid(trials: Sequence[TrialErrors], slides: Sequence[Slide], share: float) -> list[Suspicion]:
    """Return that skin slides under a marker, where it does not go with the others of its link.

    A limb whose axis is off takes all markers of a link astray with the joint, as one rigid body: a + b x place.
    """
    found = []
    key = {one: (int(trials[0].link[one.m]), one.joint) for one in slides}
    for group in dict.fromkeys(key.values()):
        own = [one for one in slides if key[one] == group]
        rigid = np.concatenate([one.turn * _astray(trials, own[0].m, one.m) for one in own])
        null = np.asarray(rigid @ rigid.T + scipy.linalg.block_diag(*[one.null(share) for one in own]))
        amplitude = np.concatenate([one.amplitude for one in own])
        sound = log_normal(amplitude, null)
        for k, one in enumerate(own):
            slid = null.copy()
            slid[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] += (_SLID_M_RAD * one.turn) ** 2 * np.eye(3)
            found.append(one.suspicion(trials, one.null(share), log_normal(amplitude, slid) - sound))
    return found


def _astray(trials: Sequence[TrialErrors], first: int, m: int) -> Floats:
    """Return how a link that shifts and turns about its first marker takes another, (3, 6), by its std."""
    apart = np.concatenate(
        [np.einsum("nji,nj->ni", t.out.axes[:, m], t.out.place[:, m] - t.out.place[:, first]) for t in trials]
    )
    x = np.nanmean(apart, axis=0) if np.isfinite(apart).all(axis=1).any() else np.zeros(3)
    across = np.array([[0.0, x[2], -x[1]], [-x[2], 0.0, x[0]], [x[1], -x[0], 0.0]])
    return np.hstack([_ASTRAY_M_RAD * np.eye(3), _ASTRAY_RAD_RAD * across])


def slopes(trials: Sequence[TrialErrors]) -> list[Slide]:
    """Return how every marker's error goes with the joints near it."""
    n_joint = trials[0].q.shape[1]
    found = []
    for m in range(len(trials[0].names)):
        link = int(trials[0].link[m])
        for joint in range(max(0, link - _NEAR + 1), min(n_joint, link + _NEAR + 1)):
            slide = _slope(trials, m, joint)
            if slide is not None:
                found.append(slide)
    return found


def _slope(trials: Sequence[TrialErrors], m: int, joint: int) -> Slide | None:
    information, pull, power, count = np.zeros((3, 3)), np.zeros(3), 0.0, 0
    parts = []
    for trial in (trials[r] for r in known_in(trials, m)):
        weight = trial.out.information[:, m]
        share = np.trace(weight, axis1=1, axis2=2)
        turn = np.where(share > 0.0, trial.q[:, joint] - np.average(trial.q[:, joint], weights=share), 0.0)
        off = np.nan_to_num(trial.out.error[:, m] - trial.mean[m])
        information += np.einsum("n,nij->ij", turn**2, weight)
        pull += np.einsum("n,nij,nj->i", turn, weight, off)
        power, count = power + float(turn @ turn), count + int((share > 0.0).sum())
        parts.append((trial, turn, weight, off))
    turned = float(np.sqrt(power / count)) if count else 0.0
    if turned < _LEAST_TURN or np.linalg.cond(information) > 1e12:
        return None
    covariance = np.linalg.inv(information)
    slope = covariance @ pull
    scores = []
    for trial, turn, weight, off in parts:
        own = np.zeros((trial.n_block, 3))
        np.add.at(own, trial.block, np.einsum("n,nij,nj->ni", turn, weight, off - turn[:, None] * slope))
        scores.append(own)
    all_scores = np.concatenate(scores)
    n = len(all_scores)
    if n < _LEAST_BLOCKS:
        return None
    covariance = covariance @ (all_scores.T @ all_scores) @ covariance * n / (n - 3)
    return Slide(m, joint, slope, covariance, turned, float(trials[0].std_m[m]))
