"""What a reference makes of an arm, and whether that is more than it may do."""

from dataclasses import dataclass

import numpy as np

from arm.control import gains
from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics, mass_matrix
from arm.simulation import Motion, simulate
from limbcal.errors import ConfigError

#: Steps of a simulation: never longer than these, while searching and at the end [s], nor than this share of the
#: arm's shortest time constant under its law.
_SEARCH_STEP_S, _STEP_S, _SHARE = 5e-3, 1e-3, 0.25
#: After this time an arm rests [s].
_SETTLED_S = 60.0


@dataclass(frozen=True)
class Limits:
    """What no joint may exceed, and, of a motion, what each reaches; one number a joint.

    Attributes
    ----------
    angle, speed, torque : (n_joint,) [rad, rad/s, N m; m, m/s, N of a joint that slides]
    """

    angle: Floats
    speed: Floats
    torque: Floats

    def excess(self, reached: "Limits") -> float:
        """Return by which share the worst of all is exceeded, 0 or less where none is."""
        pairs = ((self.angle, reached.angle), (self.speed, reached.speed), (self.torque, reached.torque))
        return max(float(np.max(most / limit)) for limit, most in pairs) - 1.0


def reached(motion: Motion) -> Limits:
    """Return how far, how fast and how strongly each joint was moved; the reference counts as an angle."""
    angle = np.maximum(np.max(np.abs(motion.q), axis=0), np.max(np.abs(motion.ref), axis=0))
    return Limits(angle, np.max(np.abs(motion.dq), axis=0), np.max(np.abs(motion.tau), axis=0))


def furthest(motions: list[Limits]) -> Limits:
    """Return the largest of several."""
    return Limits(*(np.max([getattr(m, name) for m in motions], axis=0) for name in ("angle", "speed", "torque")))


def search_step_s(arm: Arm) -> float:
    """Return a step that is long enough to search with and short enough to be right.

    Raises
    ------
    ConfigError
        If the arm has no masses, so that nothing can be simulated.
    """
    M = mass_matrix(arm, np.zeros((1, arm.n_joint)))[0]
    if not np.linalg.eigvalsh((M + M.T) / 2.0)[0] > 0.0:
        raise ConfigError(
            f"arm {arm.name}: its links have no mass that moves; expected an arm that can be simulated"
        )
    if arm.control.law == "measured":
        return _SEARCH_STEP_S
    kp, kv, ka = gains(arm.control, arm.n_joint)
    easiest = np.diag(np.linalg.inv(M - np.diag(ka)))
    fastest = float(np.max(np.maximum(np.sqrt(np.abs(kp * easiest)), np.abs(kv * easiest))))
    return min(_SEARCH_STEP_S, _SHARE / fastest) if fastest > 0.0 else _SEARCH_STEP_S


def driven(arm: Arm, reference: Floats, dt_s: float, start: Floats) -> Motion:
    """Return the motion that a reference makes: the closed loop's, or itself where the torque is measured.

    Parameters
    ----------
    arm : Arm
    reference : (3, n_sample, n_joint)
        Angle, velocity and acceleration.
    dt_s : float
    start : (n_joint,)
        Where the arm rests at the beginning.

    Returns
    -------
    Motion
        An arm that no masses can have may run away to infinity.
    """
    ref, dref, ddref = reference
    if arm.control.law == "measured":
        t = np.arange(len(ref), dtype=np.float64) * dt_s
        return Motion(t, ref, dref, ddref, inverse_dynamics(arm, ref, dref, ddref), ref)
    return simulate(arm, ref, dt_s, start)


def finely_driven(arm: Arm, reference: Floats, dt_s: float, start: Floats) -> Motion:
    """Return the motion at the samples of the reference, which is held between them, from short steps."""
    parts = 1 if arm.control.law == "measured" else max(1, int(np.ceil(dt_s / _STEP_S - 1e-9)))
    motion = driven(arm, np.repeat(reference, parts, axis=1), dt_s / parts, start)
    return Motion(*(getattr(motion, name)[::parts] for name in ("t", "q", "dq", "ddq", "tau", "ref")))


def rest_at(arm: Arm, target: Floats) -> Floats:
    """Return where the arm comes to rest at a target: there, but for what gravity and friction add."""
    if arm.control.law == "measured":
        return target
    step_s = search_step_s(arm)
    settled: Floats = simulate(arm, np.tile(target, (round(_SETTLED_S / step_s), 1)), step_s, target).q[-1]
    return settled
