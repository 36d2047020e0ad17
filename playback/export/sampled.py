"""A trial sampled as a file is to hold it: on an even grid, at its speed, with the twin beside it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from arm.effects.effect_table import changed
from arm.kinematics import sensor_positions, tip_position
from arm.model import Arm
from limbcal.errors import ConfigError, DataError
from playback.shape import REAL, TWIN, Colours
from playback.source import Source
from playback.trajectory import Floats, Trajectory

#: Frames of one file: an hour at the highest rate.
MOST_FRAMES = 3_600_000
#: Keys of one animation; a motion that takes more turns thousands of times, as angles in degrees may seem to.
MOST_KEYS = 1_000_000


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
    def posed(self) -> Arm:
        """The arm with those effects that are other numbers of it: what stands where ``q`` says."""
        return changed(self.arm)

    @cached_property
    def tip(self) -> Floats:
        """Position of the tip, (n, 3) [m]."""
        return tip_position(self.posed, self.q)

    @cached_property
    def points(self) -> Floats:
        """Positions of the sensors, (n, n_sensor, 3) [m]."""
        return sensor_positions(self.posed, self.q)


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
        Instants of the frames [s], from 0; even, unless keys were added.
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


def sample(
    source: Source, trial: int | None, rate_hz: float, speed: float, most_turn_rad: float | None = None
) -> Sampled:
    """Sample a trial of a source and of its twin.

    A file at another speed than 1 holds the motion that is that much faster: its time is shorter, its velocities
    are larger by the factor, its accelerations by the square.

    With `most_turn_rad`, instants are added between frames so that no joint turns further from one to the next:
    who reads keys that lie half a turn apart turns the other way.

    Raises
    ------
    ConfigError
        If there is no such trial, or more than `MOST_FRAMES` would be made.
    DataError
        If the motion cannot be made, or takes more than `MOST_KEYS`.
    """
    number = source.trials[0] if trial is None else trial
    motion = source.load(number)
    steps = motion.duration_s / speed * rate_hz + 1e-6  # the last node, despite rounding
    if not steps < MOST_FRAMES:
        raise ConfigError(
            f"{source.name}: {motion.duration_s:.6g} s at {rate_hz:g} Hz and {speed:g} times the speed are "
            f"{np.floor(steps) + 1.0:.9g} frames, expected at most {MOST_FRAMES}: a lower --rate-hz or a higher "
            f"--speed"
        )
    t = np.arange(int(steps) + 1) / rate_hz
    owners = [owner for owner in (source, source.twin) if owner is not None]
    motions = [motion if owner is source else owner.load(number) for owner in owners]
    if most_turn_rad is not None:
        t = _with_keys(t, owners, motions, speed, most_turn_rad)
    movers = []
    for owner, moving, colours in zip(owners, motions, (REAL, TWIN), strict=False):
        q, dq, ddq = moving.at(t * speed)
        name = owner.arm.name if owner is source else f"{owner.arm.name} (twin)"
        movers.append(Mover(name, owner.arm, q, speed * dq, speed**2 * ddq, colours))
    return Sampled(source.name, number, rate_hz, t, tuple(movers))


def _with_keys(
    t: Floats, owners: Sequence[Source], motions: Sequence[Trajectory], speed: float, most_turn_rad: float
) -> Floats:
    """Return instants with more between them wherever a joint turns further than it may."""
    while True:
        turn = np.zeros(len(t) - 1)
        for owner, motion in zip(owners, motions, strict=True):
            turning = [joint.type == "revolute" for joint in owner.arm.joints]
            steps = np.abs(np.diff(motion.at(t * speed)[0][:, turning], axis=0))
            turn = np.maximum(turn, steps.max(axis=1, initial=0.0))
        parts = np.maximum(1.0, np.ceil(turn / most_turn_rad))
        if parts.sum() > MOST_KEYS:
            raise DataError(
                f"{owners[0].name}: a joint makes {turn.sum() / (2.0 * np.pi):.3g} turns, which takes more than "
                f"{MOST_KEYS} keys; are its angles in degrees?"
            )
        if not (parts > 1.0).any():
            return t
        first = np.repeat(np.arange(len(parts)), parts.astype(int))
        place = np.arange(len(first)) - np.searchsorted(first, first)
        t = np.append(t[first] + place / parts[first] * np.diff(t)[first], t[-1])
