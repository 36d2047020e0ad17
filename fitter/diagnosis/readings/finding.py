"""What a diagnosis of the sensors found, and which experiment would say more."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from arm.model import Arm, Floats
from fitter.diagnosis.readings.remaining import Remaining

Verdict = Literal["named", "ambiguous", "none", "unexplained"]


#: What tells members of a class apart, by the effects that are in it; the first that fits counts.
_SPLITS: tuple[tuple[frozenset[str], str], ...] = (
    (
        frozenset({"sensor_bias", "sensor_scale", "sensor_clipping"}),
        "lay the arm's plane at another angle to gravity and record again: a bias stays, a wrong scale changes "
        "with what gravity shows, and a clipped axis still reads its level",
    ),
    (
        frozenset({"sensor_bias", "sensor_misalignment", "gravity_tilt"}),
        "rest the arm in several poses at which gravity shows differently: a bias stays the same in all of them",
    ),
    (
        frozenset({"mounting_radius", "sensor_scale", "sensor_misalignment"}),
        "rest the arm where gravity shows in the sensor's plane, and turn it fast: a wrong place shows only when "
        "it turns, a wrong scale or angle at rest as well",
    ),
    (
        frozenset({"sensor_drift", "sensor_highpass", "sensor_bias"}),
        "leave the arm at rest for some minutes: a drift goes on and a forgetful sensor settles",
    ),
    (
        frozenset({"time_skew", "sensor_highpass", "mounting_radius", "sensor_scale"}),
        "move with sudden starts and stops: a late sensor shows each of them late",
    ),
)


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


def next_experiment(
    verdict: Verdict, confusable: Sequence[tuple[str, str]], causes: Sequence[SensorCause], left: Remaining
) -> str:
    """Return a sentence on the motion that would tell what this data cannot."""
    if verdict == "none":
        return "none is needed for the sensors: they agree with a rigid arm as well as their noise lets them"
    if verdict == "ambiguous":
        return _splits(frozenset(effect for pair in confusable for effect in pair))
    if verdict == "named":
        whose = " and ".join(sorted({" of ".join((cause.effect, *cause.sensors)) for cause in causes}))
        return f"put right the {whose} and record once more: the sensors must then agree with a rigid arm"
    if left.depends_on:
        return f"repeat the motion with {left.depends_on[0]} over a wider range, the other joints at rest"
    return "repeat one motion several times: what comes back is the arm's, what does not is the surroundings'"


def _splits(effects: frozenset[str]) -> str:
    for known, sentence in _SPLITS:
        if effects <= known:
            return sentence
    if len(effects) == 1:
        return f"move every joint by itself, slowly and fast: it shows whose {min(effects)} it is"
    return "move every joint by itself, slowly and fast, and rest in many poses between"
