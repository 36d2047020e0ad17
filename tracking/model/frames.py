"""What a tracker gives out: joint and tip motion, block by block, and when the arm moved."""

from dataclasses import dataclass
from typing import Literal

from arm.model import Floats

#: Readings (n, n_channel) in a row, and the time [ns] of the first.
Block = tuple[int, Floats]


@dataclass(frozen=True)
class Frames:
    """Consecutive frames of joint and tip motion.

    Attributes
    ----------
    frame0 : int
        Number of the first frame since tracking began; lost frames are counted.
    t0_ns : int
        Time of the first frame.
    dt_s : float
        From one frame to the next.
    q, dq, ddq : (n, n_joint) [rad or m, and derivatives]
    tip : (n, 3) [m]
        By eq. (2) from the angles, in the base frame.
    points : (n, n_sensor, 3) [m]
        How far each sensor has moved since tracking began, in the base frame: dead reckoning from the
        accelerations, never computed from the arm's lengths.
    gap : bool
        Samples were lost since the frames before, or within these: what is missing was predicted.
    q_std : (n, n_joint) or None
        How well the angles are known, by the tracker's own claim, where it makes one.
    readings : (n, n_channel) or None [m/s^2, of gyroscopes rad/s]
        What the sensors read, averaged to the frames; not a number where it was lost.
    noise : (2, n_channel) or None [squares of these]
        Of these readings: the variance of their white noise, and of what the converter hides from all alike.
    """

    frame0: int
    t0_ns: int
    dt_s: float
    q: Floats
    dq: Floats
    ddq: Floats
    tip: Floats
    points: Floats
    gap: bool
    q_std: Floats | None = None
    readings: Floats | None = None
    noise: Floats | None = None

    @property
    def n(self) -> int:
        """Number of frames."""
        return len(self.q)


@dataclass(frozen=True)
class Phase:
    """A motion began or ended. Motions are counted from 1."""

    kind: Literal["begin", "end"]
    t_ns: int
    trial: int
