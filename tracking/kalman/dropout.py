"""What is still held of a motion that is not seen: for how long it is predicted, and where it may have gone."""

import numpy as np

from arm.model import Floats
from tracking.model.process_noise import SMOOTHER_PUSH_STD

#: What is known of angle, speed and acceleration of a joint that was not seen for long [rad or m, and
#: derivatives].
LOST_STD = (0.5, 3.0, 10.0)
#: A motion can be predicted for this long, and its two ends tell for this long what it was [s].
PREDICTABLE_S, TOLD_S = 0.25, 1.5


def most_probable_way(T: float, v0: Floats, a0: Floats, v1: Floats, a1: Floats) -> Floats:
    """Return how far joints most probably came in a time T, from speeds and accelerations at both ends.

    Their accelerations are pushed at random; see `Loss.regain`.
    """
    way: Floats = 0.5 * T * (v0 + v1) + T**2 / 12.0 * (a0 - a1)
    return way


class Loss:
    """Counts the frames whose readings are missing.

    Parameters
    ----------
    n_joint : int
    dt_s : float
        From frame to frame.

    Attributes
    ----------
    frames : int
        Missing in a row until now.
    before : (n_joint, 3)
        Angles, speeds and accelerations at the last reading.
    """

    def __init__(self, n_joint: int, dt_s: float) -> None:
        self.frames = 0
        self.before = np.zeros((n_joint, 3))
        self._n, self._dt = n_joint, dt_s

    @property
    def seconds(self) -> float:
        """For how long nothing was read."""
        return self.frames * self._dt

    @property
    def lost(self) -> bool:
        """Whether that is longer than a motion can be predicted."""
        return self.seconds > PREDICTABLE_S

    def miss(self, x: Floats, P: Floats) -> bool:
        """Count a frame without a reading; return whether the motion is lost.

        Then state and covariance, of the frame before, are changed accordingly: the motion may be going on, nobody
        knows where to.
        """
        if self.frames == 0:
            self.before = x[: 3 * self._n].reshape(-1, 3).copy()
        was_lost = self.lost
        self.frames += 1
        if self.lost and not was_lost:
            self.forget(x, P)
        if self.lost:
            angles = np.arange(0, 3 * self._n, 3)
            P[angles, angles] += LOST_STD[0] ** 2 * self._dt
        return self.lost

    def retime(self, dt_s: float) -> None:
        """Go on with another time from frame to frame."""
        self._dt = dt_s

    def skip(self, frames: int) -> None:
        """Count frames that nobody gives out."""
        self.frames += frames

    def find(self) -> None:
        """Begin anew: there is a reading."""
        self.frames = 0

    def forget(self, x: Floats, P: Floats) -> None:
        """Forget the motion: the arm is about where it was, what is known of the sensors stays."""
        n = 3 * self._n
        x[1:n:3], x[2:n:3] = 0.0, 0.0
        P[:n], P[:, :n] = 0.0, 0.0
        P[np.arange(n), np.arange(n)] = np.tile(np.square(LOST_STD), self._n)

    def regain(self, later_s: float, x: Floats, P: Floats) -> None:
        """Change state and covariance, as `miss` left them, to what may have become of the motion since.

        An acceleration that is pushed at random, by `SMOOTHER_PUSH_STD`^2 = q a second, and is known with the
        speed at both ends of a time T, has most probably come as far as
        ``T (v0 + v1) / 2 + T^2 (a0 - a1) / 12``; of the variance, q T^5 / 20 where only the beginning is known,
        q T^5 / 720 is left. So what is learnt of v1 and a1 from now on is learnt of the angle, too. After more
        than `TOLD_S` the motion before tells nothing any more.

        Parameters
        ----------
        later_s : float
            How long after the last missing frame that is.
        x, P
        """
        T = self.seconds + later_s
        if T > TOLD_S:
            return
        q0, v0, a0 = self.before.T
        nothing = np.zeros(self._n)  # is known of v1 and a1 yet
        x[0 : 3 * self._n : 3] = q0 + most_probable_way(T, v0, a0, nothing, nothing)
        slope = np.array([0.5 * T, -(T**2) / 12.0])
        for q in range(0, 3 * self._n, 3):
            ends = slice(q + 1, q + 3)
            P[q, ends] = P[ends, q] = P[ends, ends] @ slope
            P[q, q] = min(P[q, q], SMOOTHER_PUSH_STD**2 * T**5 / 720.0) + slope @ P[ends, ends] @ slope
