"""The motion that would distinguish what this one could not, or show what it could not show."""

from collections.abc import Sequence

#: For effects that look alike: what to do, the first entry that has all of them.
_SPLITS: tuple[tuple[frozenset[str], str], ...] = (
    (
        frozenset({"torque_offset", "coulomb_asymmetry"}),
        "move {joints} slowly both ways and let it come to rest without friction holding it (by tapping, or on a "
        "slow ramp of torque until it lets go): an offset pulls at rest too, asymmetric friction does not",
    ),
    (
        frozenset({"actuator_delay", "actuator_lag"}),
        "give {joints} steps and a fast sine of some 10 Hz: a lag makes the torque smaller with the frequency, "
        "a delay only later",
    ),
    (
        frozenset({"actuator_delay", "joint_elasticity"}),
        "hold {joints} by hand and give it a slow torque: an elastic transmission twists at rest, a delay does "
        "not show",
    ),
    (
        frozenset({"gravity_tilt", "joint_zero"}),
        "move joint 1 through as much of a turn as it has, and tilt the base by a known angle: only gravity "
        "follows",
    ),
    (
        frozenset({"gain_error"}),
        "hang a known mass at the tip, or measure one joint's torque: angles alone tell the ratio of the joints' "
        "gains, not which one is off",
    ),
    (
        frozenset({"stribeck", "backlash"}),
        "reverse {joints} slowly under a constant load: play jumps at the reversal, friction does not",
    ),
    (
        frozenset({"joint_spring", "end_stop"}),
        "move {joints} slowly through all of its range: a spring pulls everywhere, a stop on one side only",
    ),
    (
        frozenset({"passive_tissue", "joint_spring"}),
        "move {joints} slowly up to the end of its range: tissue stiffens e-fold over a few degrees there, a "
        "spring keeps its stiffness",
    ),
    (
        frozenset({"passive_tissue", "end_stop"}),
        "move {joints} slowly into the end of its range, a little further each time: tissue stiffens little by "
        "little, a stop begins at one angle",
    ),
    (
        frozenset({"load_friction", "gain_error"}),
        "repeat the motions with a known mass at the tip: friction that grows with the load grows, a gain does "
        "not",
    ),
    (
        frozenset({"payload", "gain_error"}),
        "repeat the motions without load: a payload goes away, a gain stays",
    ),
)

#: What distinguishes members of a class, by the effects that are in it; the first that fits counts.
_SENSOR_SPLITS: tuple[tuple[frozenset[str], str], ...] = (
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


def next_experiment(verdict: str, alike: Sequence[str], joints: Sequence[int], depends_on: Sequence[str]) -> str:
    """Return what to do next, in one sentence.

    Parameters
    ----------
    verdict : {"named", "ambiguous", "none", "unexplained"}
    alike : sequence of str
        Effects that explain the data equally well.
    joints : sequence of int
        Where, from 1.
    depends_on : sequence of str
        What an unexplained remainder depends on.
    """
    where = " and ".join(f"joint {j}" for j in sorted(set(joints))) or "the arm"
    if verdict == "ambiguous":
        for effects, sentence in _SPLITS:
            if effects <= set(alike):
                return _sentence(sentence.format(joints=where))
        return _sentence(
            f"drive {where} with other motions (`fitter excite` suggests one): faster, slower, through the whole "
            f"range, and with another load, until {' and '.join(sorted(set(alike)))} no longer look alike"
        )
    if verdict == "unexplained":
        varied = [name for name in depends_on if name != "t"]
        if not varied:
            return _sentence(
                "repeat one and the same motion over and over, some after a pause: the residual then tells "
                "whether it comes with the run's own time, such as warmth or a changed load, or with each motion"
            )
        return _sentence(
            f"vary {', '.join(varied)} alone, with everything else held as it is: slow sweeps, both ways, several "
            "times over"
        )
    if verdict == "none":
        return _sentence(
            "nothing more is needed for these motions; faster and wider ones, another load and longer runs would "
            "show smaller effects"
        )
    return _sentence(
        f"repeat some motions with the cause at {where} put right or changed: the effect should follow it"
    )


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:] + "."


def next_for_sensors(
    verdict: str,
    confusable: Sequence[tuple[str, str]],
    causes: Sequence[tuple[str, ...]],
    depends_on: Sequence[str],
) -> str:
    """Return a sentence on the motion that would tell what readings alone cannot.

    Parameters
    ----------
    verdict : {"named", "ambiguous", "none", "unexplained"}
    confusable : sequence of pairs of effects
    causes : sequence of (effect, sensor, ...)
    depends_on : sequence of str
        What an unexplained remainder depends on.
    """
    if verdict == "none":
        return "none is needed for the sensors: they agree with a rigid arm as well as their noise lets them"
    if verdict == "ambiguous":
        return _split_of_sensors(frozenset(effect for pair in confusable for effect in pair))
    if verdict == "named":
        whose = " and ".join(sorted({" of ".join(cause) for cause in causes}))
        return f"put right the {whose} and record once more: the sensors must then agree with a rigid arm"
    if depends_on:
        return f"repeat the motion with {depends_on[0]} over a wider range, the other joints at rest"
    return "repeat one motion several times: what comes back is the arm's, what does not is the surroundings'"


def _split_of_sensors(effects: frozenset[str]) -> str:
    for known, sentence in _SENSOR_SPLITS:
        if effects <= known:
            return sentence
    if len(effects) == 1:
        return f"move every joint by itself, slowly and fast: it shows whose {min(effects)} it is"
    return "move every joint by itself, slowly and fast, and rest in many poses between"
