"""Where an arm is touched, and where the hand is that does it."""

from dataclasses import dataclass

from arm.model import Floats


@dataclass(frozen=True)
class Grip:
    """Where an arm is touched: the link, counted from 1, and the point in its joint-axis frame [m]."""

    joint: int
    point_m: tuple[float, float, float]


@dataclass(frozen=True)
class Hand:
    """Where the hand is, in the base frame: place [m], and where known velocity and orientation (3, 3)."""

    position: Floats
    velocity: Floats | None = None
    orientation: Floats | None = None
