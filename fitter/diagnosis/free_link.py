"""How a link moves under a torque: by its inertia, what resists it, and its own dry friction."""

from dataclasses import dataclass, replace

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled


@dataclass(frozen=True)
class FreeLink:
    """What moves a link beside its motor.

    Attributes
    ----------
    t : (n_sample,) [s]
        The run's time.
    inertia : (n_sample,)
        About its joint [kg m^2], or its mass [kg].
    resistance : (n_sample,) [N m or N]
        What gravity and the other joints' motion ask of a motor that holds its velocity, without friction.
    viscous, coulomb : float
        Its friction [N m s/rad], [N m], or [N s/m], [N].
    lacking : float [N m or N]
        The rms of what else acts on it for some tenths of a second; infinite where that is not known.
    """

    t: Floats
    inertia: Floats
    resistance: Floats
    viscous: float
    coulomb: float
    lacking: float

    def at(self, t: Floats) -> "FreeLink":
        """Return the same at other instants; beyond its ends as there."""
        inertia, resistance = (np.interp(t, self.t, one) for one in (self.inertia, self.resistance))
        return replace(self, t=t, inertia=inertia, resistance=resistance)

    def lacking_acceleration(self, samples: slice) -> float:
        """Return the rms of the acceleration of what else acts on it [rad/s^2]; infinite if nothing is known."""
        return self.lacking / float(np.mean(self.inertia[samples])) if np.isfinite(self.lacking) else np.inf

    def moved(
        self, samples: slice, torque: Floats, angle: float, speed: float, dt_s: float
    ) -> tuple[Floats, Floats]:
        """Return angles and speeds of a link from some angle and speed on.

        Parameters
        ----------
        samples : slice
            From the first to behind the last.
        torque : (n_sample,) [N m or N]
            Of its motor, 0 while that crosses a gap.
        angle, speed : float [rad], [rad/s]
            At the first.
        dt_s : float

        Returns
        -------
        (n_sample,) [rad], (n_sample,) [rad/s]
        """
        pulled = torque - self.resistance[samples]
        angles, speeds = _moved(self.inertia[samples], pulled, self.viscous, self.coulomb, angle, speed, dt_s)
        return angles, speeds


def weightless(t: Floats) -> FreeLink:
    """Return a link that nothing moves: of it no inertia is known, and nothing of where it goes."""
    return FreeLink(t, np.full(len(t), np.inf), np.zeros(len(t)), 0.0, 0.0, np.inf)


@compiled
def _moved(
    inertia: Floats, pulled: Floats, viscous: float, coulomb: float, angle: float, speed: float, dt_s: float
) -> tuple[Floats, Floats]:
    """Return angles and speeds of a link (n_sample,) that begins with an angle and a speed.

    Dry friction takes as much of a step's speed as it can, and no more than there is (time stepping: Moreau 1988).
    """
    angles, speeds = np.empty(len(inertia)), np.empty(len(inertia))
    angles[0], speeds[0] = angle, speed
    for k in range(1, len(inertia)):
        free = speeds[k - 1] + dt_s * (pulled[k - 1] - viscous * speeds[k - 1]) / inertia[k - 1]
        speeds[k] = np.sign(free) * max(abs(free) - dt_s * coulomb / inertia[k - 1], 0.0)
        angles[k] = angles[k - 1] + 0.5 * dt_s * (speeds[k - 1] + speeds[k])
    return angles, speeds
