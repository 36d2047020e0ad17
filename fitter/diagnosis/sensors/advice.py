"""Which experiment would say more."""

from collections.abc import Sequence

from fitter.diagnosis.sensors.finding import SensorCause, Verdict
from fitter.diagnosis.sensors.remaining import Remaining

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
