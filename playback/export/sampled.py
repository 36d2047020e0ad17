"""A trial sampled as a file is to hold it: on an even grid, at its speed, with the twin beside it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from arm.kinematics import sensor_positions, tip_position
from arm.model import Arm
from playback.shape import REAL, TWIN, Colours
from playback.source import Source
from playback.trajectory import Floats


@dataclass(frozen=True)
class Mover:
    """One arm and its motion at the instants of a file.

    Parameters
    ----------
    name : str
        Unlike that of the arm beside it.
    arm : Arm
    q, dq, ddq : ndarray of shape (n, n_joint)
    colours : Colours
    """

    name: str
    arm: Arm
    q: Floats
    dq: Floats
    ddq: Floats
    colours: Colours

    @cached_property
    def tip(self) -> Floats:
        """Position of the tip, (n, 3) [m]."""
        return tip_position(self.arm, self.q)

    @cached_property
    def points(self) -> Floats:
        """Positions of the sensors, (n, n_sensor, 3) [m]."""
        return sensor_positions(self.arm, self.q)


@dataclass(frozen=True)
class Sampled:
    """What goes into a file.

    Parameters
    ----------
    title : str
        What moves, in words.
    trial : int
    rate_hz : float
        Frames a second of the file.
    t : ndarray of shape (n,)
        Instants of the frames [s], from 0.
    movers : tuple of Mover
        The arm, and its twin where there is one.
    """

    title: str
    trial: int
    rate_hz: float
    t: Floats
    movers: tuple[Mover, ...]

    @property
    def duration_s(self) -> float:
        """Time from the first frame to the last."""
        return float(self.t[-1])


def sample(source: Source, trial: int | None, rate_hz: float, speed: float) -> Sampled:
    """Sample a trial of a source and of its twin.

    A file at another speed than 1 holds the motion that is that much faster: its time is shorter, its velocities
    are larger by the factor, its accelerations by the square.

    Raises
    ------
    ConfigError
        If there is no such trial.
    DataError
        If the motion cannot be made.
    """
    number = source.trials[0] if trial is None else trial
    motion = source.load(number)
    n_frame = int(motion.duration_s / speed * rate_hz + 1e-6) + 1  # the last node, despite rounding
    t = np.arange(n_frame) / rate_hz
    movers = []
    for owner, colours in ((source, REAL), (source.twin, TWIN)):
        if owner is None:
            continue
        q, dq, ddq = (motion if owner is source else owner.load(number)).at(t * speed)
        name = owner.arm.name if owner is source else f"{owner.arm.name} (twin)"
        movers.append(Mover(name, owner.arm, q, speed * dq, speed**2 * ddq, colours))
    return Sampled(source.name, number, rate_hz, t, tuple(movers))
