"""Effects that change the arm itself: gravity, a joint's zero, a rotor, air, a load."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.effects.effect import EffectKind
from arm.model import Floats, Friction, Link
from arm.newton_euler import inverse_dynamics
from arm.regressor import regressor
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View

#: By the third General Conference on Weights and Measures, 1901 [m/s^2].
STANDARD_GRAVITY = 9.80665
#: Tilts that are tried first [m/s^2], and zeros [rad].
_TILTS = (-0.1, 0.1)
_ZEROS = (-0.02, 0.02)


class GravityTilt(Hypothesis):
    """Gravity has a part in the plane that the arm file does not know of."""

    is_gradual = True
    nothing = (0.0, 0.0)

    @property
    def low(self) -> Floats:
        """Least values, (2,)."""
        return np.array([-15.0, -15.0])

    @property
    def high(self) -> Floats:
        """Greatest values, (2,)."""
        return np.array([15.0, 15.0])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first: a little of it, and all of it along eight directions of a level plane."""
        turns = np.arange(8) * np.pi / 4.0
        upright = STANDARD_GRAVITY * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        return np.concatenate([[[x, y] for x in _TILTS for y in _TILTS], upright])

    def inside(self, psi: Floats) -> Floats:
        """Return a vector (2,) that is no longer than gravity."""
        return np.asarray(psi * min(1.0, STANDARD_GRAVITY / max(float(np.hypot(*psi)), STANDARD_GRAVITY)))

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion in another gravity."""
        (x, y, z), (dx, dy) = view.arm.gravity_m_s2, self.inside(psi)
        return replace(view, arm=replace(view.arm, gravity_m_s2=(x + dx, y + dy, z)))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the two components."""
        return self.inside(psi)


class JointZero(Hypothesis):
    """The angle of a link is off by a constant."""

    is_gradual = True
    nothing = (0.0,)

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([-1.5])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([1.5])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first."""
        return np.array(_ZEROS)[:, None]

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion with another angle."""
        q = view.q.copy()
        q[:, self.joints[0]] += psi[0]
        return replace(view, q=q)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the offset."""
        return np.array(psi)


class RotorInertia(Hypothesis):
    """Something turns with a joint that no link carries."""

    n_column = 1

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion with the joint's acceleration as a column of its own."""
        j = self.joints[0]
        column = np.zeros((*view.q.shape, 1))
        column[:, j, 0] = view.ddq[:, j]
        return replace(view, columns=(*view.columns, column))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the inertia."""
        return np.array(factors)


class AirDrag(Hypothesis):
    """A link is resisted as it turns in space."""

    n_column = 1

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion with the torque of a unit of drag as a column of its own."""
        links = [Link(air_drag_N_m_s2=1.0 if j in self.joints else 0.0) for j in range(view.arm.n_joint)]
        joints = [
            replace(joint, link=link, friction=Friction())
            for joint, link in zip(view.arm.joints, links, strict=True)
        ]
        massless = replace(view.arm, joints=tuple(joints))
        column = inverse_dynamics(massless, view.q, view.dq, view.ddq)[..., None]
        return replace(view, columns=(*view.columns, column))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the drag."""
        return np.array(factors)


class Payload(Hypothesis):
    """A point mass at the tip, in some trials or from some time on.

    Parameters
    ----------
    kind : EffectKind
    trials : frozenset of int
        The trials in which it is there, from 1 over the run; or
    since_s : float, optional
        from when on.
    """

    n_column = 1
    is_event = True
    comes_and_goes = True

    def __init__(
        self, kind: EffectKind, trials: frozenset[int] = frozenset(), since_s: float | None = None
    ) -> None:
        super().__init__(kind, ())
        self.trials = trials
        self.since_s = since_s

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion with what a kilogram at the tip would ask of the joints while it is there."""
        column = tip_mass_column(view)
        if self.since_s is not None:
            column = column * (view.motion.t >= self.since_s)[:, None, None]
        elif view.motion.number not in self.trials:
            column = np.zeros_like(column)
        return replace(view, columns=(*view.columns, column))

    def log_places(self, motions: Sequence[Motion]) -> float:
        """Return the logarithm of the number of sets of trials, or of moments."""
        if self.since_s is None:
            return float(len(motions) * np.log(2.0))
        return float(np.log(sum(len(motion.t) for motion in motions)))

    def part_of(self, motion: Motion) -> object:
        """Return whether it is there, or from when on."""
        if self.since_s is None:
            return motion.number in self.trials
        begun = motion.t[[0, -1]] >= self.since_s
        return bool(begun[0]) if begun[0] == begun[1] else self.since_s

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the mass."""
        return np.array(factors)

    @property
    def names(self) -> tuple[str, ...]:
        """The mass alone is a number with an error."""
        return ("mass_kg",)

    @property
    def units(self) -> tuple[str, ...]:
        """Of the mass."""
        return ("kg",)


def tip_mass_column(view: View) -> Floats:
    """Return the torque of one kilogram at the tip, (n_sample, n_joint, 1)."""
    n = view.arm.n_joint
    a = view.arm.joints[-1].a_m
    mass = np.zeros(12 * n)
    mass[10 * (n - 1) : 10 * n] = [0.0, a * a, a * a, 0.0, 0.0, 0.0, a, 0.0, 0.0, 1.0]
    torque = regressor(view.arm, view.q, view.dq, view.ddq) @ mass
    return np.asarray(torque[..., None], dtype=np.float64)


def arm_hypotheses(kind: EffectKind, n_joint: int) -> list[Hypothesis]:
    """Return the places where an effect of the arm may be; loads are sought elsewhere, for they are events."""
    if kind.name == "gravity_tilt":
        return [GravityTilt(kind, ())]
    if kind.name == "air_drag":  # at the first joint it is what quadratic_drag is
        return [AirDrag(kind, (j,)) for j in range(1, n_joint)]
    makers = {"joint_zero": JointZero, "rotor_inertia": RotorInertia}
    return [makers[kind.name](kind, (j,)) for j in range(n_joint)] if kind.name in makers else []
