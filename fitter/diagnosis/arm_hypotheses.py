"""Hypotheses of the arm itself: gravity, a joint's zero, a rotor, air drag, friction that drifts."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import STANDARD_GRAVITY_M_S2, Floats, Friction, Link
from arm.newton_euler import inverse_dynamics
from fitter.diagnosis.least_squares import NEGLIGIBLE
from fitter.diagnosis.model import ActionOrder, Hypothesis
from fitter.diagnosis.motion import HypotheticalMotion, Motion


class GravityTilt(Hypothesis):
    """Gravity has a part in the plane that the arm file does not know of."""

    turn = ActionOrder.ARM
    is_gradual = True
    mixes_noise = True
    nothing = (0.0, 0.0)

    @property
    def low(self) -> Floats:
        """Least values, (2,)."""
        return np.full(2, -2.0 * STANDARD_GRAVITY_M_S2)

    @property
    def high(self) -> Floats:
        """Greatest values, (2,)."""
        return np.full(2, 2.0 * STANDARD_GRAVITY_M_S2)

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first: a little of it, and all of it along eight directions of a level plane."""
        small = NEGLIGIBLE * STANDARD_GRAVITY_M_S2
        turns = np.arange(8) * np.pi / 4.0
        upright = STANDARD_GRAVITY_M_S2 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        return np.concatenate([small * np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]]), upright])

    def inside(self, psi: Floats) -> Floats:
        """Return a vector (2,) that is no longer than gravity."""
        return np.asarray(
            psi * min(1.0, STANDARD_GRAVITY_M_S2 / max(float(np.hypot(*psi)), STANDARD_GRAVITY_M_S2))
        )

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion in another gravity."""
        (x, y, z), (dx, dy) = hypothetical.arm.gravity_m_s2, self.inside(psi)
        return replace(hypothetical, arm=replace(hypothetical.arm, gravity_m_s2=(x + dx, y + dy, z)))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the two components."""
        return self.inside(psi)


class JointZero(Hypothesis):
    """The angle of a link is off by a constant."""

    turn = ActionOrder.ARM
    is_gradual = True
    mixes_noise = True
    nothing = (0.0,)

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([-np.pi / 2.0])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([np.pi / 2.0])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first."""
        return np.array([[-NEGLIGIBLE], [NEGLIGIBLE]])

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with another angle."""
        q = hypothetical.q.copy()
        q[:, self.joints[0]] += psi[0]
        return replace(hypothetical, q=q)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the offset."""
        return np.array(psi)


class RotorInertia(Hypothesis):
    """Something turns with a joint that no link carries."""

    n_column = 1

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with the joint's acceleration as a column of its own."""
        j = self.joints[0]
        column = np.zeros((*hypothetical.q.shape, 1))
        column[:, j, 0] = hypothetical.ddq[:, j]
        return replace(hypothetical, columns=(*hypothetical.columns, column))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the inertia."""
        return np.array(factors)


class AirDrag(Hypothesis):
    """A link is resisted as it turns in space."""

    n_column = 1

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion with the torque of a unit of drag as a column of its own."""
        drag = [1.0 if j in self.joints else 0.0 for j in range(hypothetical.arm.n_joint)]
        column = drag_column(hypothetical, drag)[..., None]
        return replace(hypothetical, columns=(*hypothetical.columns, column))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the drag."""
        return np.array(factors)


def drag_column(hypothetical: HypotheticalMotion, drag: Sequence[float]) -> Floats:
    """Return the torque of the links' air drag alone, (n_sample, n_joint).

    Parameters
    ----------
    hypothetical : HypotheticalMotion
    drag : sequence of float [N m s^2/rad^2]
        Of each link.
    """
    joints = [
        replace(joint, link=Link(air_drag_N_m_s2=of_link), friction=Friction())
        for joint, of_link in zip(hypothetical.arm.joints, drag, strict=True)
    ]
    massless = replace(hypothetical.arm, joints=tuple(joints))
    return inverse_dynamics(massless, hypothetical.q, hypothetical.dq, hypothetical.ddq)


class FrictionDrift(Hypothesis):
    """Viscous and Coulomb friction of one joint grow alike with the run's time."""

    turn = ActionOrder.FRICTION
    is_gradual = True
    is_inertial = False
    nothing = (0.0,)

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([self.kind.parameters[0].low])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([self.kind.parameters[0].high])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first, (2, 1): half of the friction comes or goes in the run."""
        return np.array([[-0.5], [0.5]]) / float(motions[-1].t[-1] - motions[0].t[0])

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose friction drifts."""
        drift = hypothetical.drift.copy()
        drift[self.joints[0]] += psi[0]
        return replace(hypothetical, drift=drift)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the rate."""
        return np.array(psi)
