"""What a diagnosis of the sensors found."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from arm.model import Arm, Floats
from fitter.diagnosis.sensors.remaining import Remaining

Verdict = Literal["named", "ambiguous", "none", "unexplained"]


@dataclass(frozen=True)
class Number:
    """A parameter with its standard error."""

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class SensorCause:
    """A cause.

    Attributes
    ----------
    effect : str
        As in the catalogue.
    sensors : tuple of str
        Empty for an effect that all sensors feel.
    parameters : mapping of str to Number
    support : float
        From 0 to 1: in which share of the ways to draw the judging trials anew it beats every rival that is not
        its equal; shared among equals.
    """

    effect: str
    sensors: tuple[str, ...]
    parameters: Mapping[str, Number]
    support: float


@dataclass(frozen=True)
class SensorCandidate:
    """An effect that was tried on the arm file's own sensors.

    Attributes
    ----------
    effect : str
    sensors : tuple of str
    gain : float
        Share of what contradicts a rigid arm in the judging trials that it takes away, 0 to 1.
    support : float
    """

    effect: str
    sensors: tuple[str, ...]
    gain: float
    support: float


@dataclass(frozen=True)
class Course:
    """Judging trials for a plot.

    Attributes
    ----------
    t : (n,) [s]
        On the run's clock.
    before, after : (n, n_sensor, 3) [m/s^2]
        What no motion explains of the readings, without the causes and with them.
    fitted : (n, n_sensor, 3) [m/s^2]
        What the causes say the sensors read.
    """

    t: Floats
    before: Floats
    after: Floats
    fitted: Floats


@dataclass(frozen=True)
class SensorFinding:
    """Whether the sensors contradict a rigid arm, and why.

    Attributes
    ----------
    verdict : {"named", "ambiguous", "none", "unexplained"}
    causes : tuple of SensorCause
        Of an ambiguous finding all that explain equally well.
    candidates : tuple of SensorCandidate
        All that were tried, the best first.
    confusable : tuple of (str, str)
        Effects that this data cannot tell apart.
    next_experiment : str
    before, after : mapping of str to float
        By sensor, rms of what no motion of a rigid arm explains in the judging trials [m/s^2].
    gain : float
        Share of what contradicts beyond noise that the causes take away.
    contradicts : float
        Of the arm file as it is: how many standard deviations of mere noise the sensors are from a rigid arm.
    residual : Remaining
    arm : Arm
        With the causes as its effects.
    course : Course
    """

    verdict: Verdict
    causes: tuple[SensorCause, ...]
    candidates: tuple[SensorCandidate, ...]
    confusable: tuple[tuple[str, str], ...]
    next_experiment: str
    before: Mapping[str, float]
    after: Mapping[str, float]
    gain: float
    contradicts: float
    residual: Remaining
    arm: Arm
    course: Course
