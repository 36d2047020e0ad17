"""Angles in degrees where radians are expected, of all joints or of some.

Every joint may be in degrees by itself: a reading says which are. Readings are compared by how far and fast joints
move, by what the best inertias leave of each joint's torque, and by how far the tip travels.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from arm.model import Arm, Floats
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import (
    path_lengths,
    rate_ratio,
    reach,
    torque_residual,
    turning,
)
from fitter.data.plausibility.refusal import Refusal
from protocol.tables.magnitude import (
    EFFECTIVE_SAMPLES,
    REACH_RATIO,
    SI,
    SURE,
    likely,
    probabilities,
)
from protocol.tables.turning import DEGREE, top_speeds, turning_likelihood

#: A given rate agrees with the slope of what it is of within this factor.
_AGREES = 1.5
#: A torque that is explained better than this, as a fraction of its power, is explained but for rounding.
_ROUNDING = 1e-6
#: Prior probability that a torque contradicts the angles for another reason (its columns, its sign, an encoder
#: that froze): as rare as a unit that is not SI.
_FAULTY = 1.0 - SI

Joints = tuple[int, ...]


def look(motion: Measured, arm: Arm) -> Measured:
    """Return the motion, or refuse it where angles of some or all joints are not in radians.

    Raises
    ------
    Refusal
        With the likely unit.
    """
    turns = turning(arm)
    if "q" not in motion.columns or len(motion.t) < 3 or not turns.any():
        return motion
    joints = [j for j in np.flatnonzero(turns).tolist() if f"q{j + 1}" not in motion.stated]
    if not joints:
        return motion
    _agree_with_rates(motion, joints)
    q = motion.columns["q"]
    ranges, speeds = np.ptp(q, axis=0), top_speeds(motion.t, q)
    scales = {
        degrees: np.where(np.isin(np.arange(arm.n_joint), degrees), DEGREE, 1.0) for degrees in _readings(joints)
    }
    weight = _by_torque(motion, arm, scales)
    for degrees, scale in scales.items():
        weight[degrees] += turning_likelihood(scale[joints] * ranges[joints], scale[joints] * speeds[joints])
        weight[degrees] += _by_tip(motion, arm, scale[joints], joints)
    best = likely(weight, ())
    if best is None:
        return motion
    found, rest = _named(probabilities(weight, ()), best, joints)
    j = found[int(np.argmax(ranges[list(found)]))]
    seen = f"joint {j + 1} moves {ranges[j]:.3g} rad to and fro at up to {speeds[j]:.3g} rad/s: "
    seen += "degrees?" if len(found) == len(joints) else f"{_asked('q', found)} in degrees{rest}?"
    raise _refusal(motion, "q", seen, found, joints)


def _named(probability: Mapping[Joints, float], best: Joints, joints: Sequence[int]) -> tuple[Joints, str]:
    """Return the joints to ask about, those that are nearly certain if any is, and what to say of the others."""
    each = {j: sum(p for reading, p in probability.items() if j in reading) for j in joints}
    found = tuple(j for j in joints if each[j] > SURE) or best
    alone = all(each[j] < 1.0 - SURE for j in joints if j not in found)
    return found, ", the others not" if alone else ""


def _readings(joints: Sequence[int]) -> list[Joints]:
    """Return which joints may be in degrees: none, one, all but one, or all; of up to three joints, any."""
    n = len(joints)
    return [some for size in sorted({0, 1, n - 1, n}) for some in combinations(joints, size)]


def _agree_with_rates(motion: Measured, joints: Sequence[int]) -> None:
    """Refuse a motion in which a joint's angle, velocity and acceleration are a degree's factor apart."""
    for of, rate in (("q", "dq"), ("dq", "ddq")):
        ratios = rate_ratio(motion, of, rate)
        if ratios is None:
            continue
        for column, scale in ((of, 1.0 / DEGREE), (rate, DEGREE)):
            found = tuple(j for j in joints if 1.0 / _AGREES < abs(ratios[j]) * scale < _AGREES)
            if not found:
                continue
            other = rate if column == of else of
            ratio = 1.0 / float(np.median(ratios[list(found)]))
            if len(found) == len(joints):
                seen = f"the slope of {of} is {ratio:.4g} times {rate}: is {column} in degrees, {other} not?"
            else:
                one, asked = found[0] + 1, _asked(column, found)
                seen = f"the slope of {of}{one} is {ratio:.4g} times {rate}{one}: {asked} in degrees?"
            raise _refusal(motion, column, seen, found, joints)


def _by_torque(motion: Measured, arm: Arm, scales: Mapping[Joints, Floats]) -> dict[Joints, float]:
    """Return the log likelihood of the torque under each reading.

    Each joint's residual is Gaussian with a size of its own. What a model lacks is alike in all joints, so that
    they have the effective samples of one between them. Or the torque has a fault of its own, whatever the unit:
    then what any reading leaves of a joint's is as likely to be one fraction as another.
    """
    log_left = {}
    for reading, scale in scales.items():
        left = torque_residual(arm, motion, scale)
        if left is None:
            return dict.fromkeys(scales, 0.0)
        log_left[reading] = np.log(np.maximum(left[np.isfinite(left)], _ROUNDING))
    sound = {reading: -0.5 * EFFECTIVE_SAMPLES * float(logs.mean()) for reading, logs in log_left.items()}
    best = max(sound, key=lambda reading: sound[reading])
    faulty = np.log(_FAULTY) + sound[best] + float(log_left[best].sum())
    return {reading: float(np.logaddexp(value, faulty)) for reading, value in sound.items()}


def _by_tip(motion: Measured, arm: Arm, scale: Floats, joints: Sequence[int]) -> float:
    """Return the log likelihood of how far the tip travels, by how far joints turn."""
    turned = float(scale @ path_lengths(motion.columns["q"][:, joints]))
    if "tip" not in motion.columns or not (reach(arm) > 0.0 and turned > 0.0):
        return 0.0
    travelled = float(np.linalg.norm(path_lengths(motion.columns["tip"])))
    return REACH_RATIO.log_likelihood(travelled / turned / reach(arm))


def _asked(column: str, joints: Joints) -> str:
    names = [f"{column}{j + 1}" for j in joints]
    return f"{'is' if len(names) == 1 else 'are'} {' and '.join(names)}"


def _refusal(motion: Measured, column: str, seen: str, found: Joints, joints: Sequence[int]) -> Refusal:
    ends = ["{j}"] if len(found) == len(joints) else [str(j + 1) for j in found]
    deg, rad = (
        ",".join(f"{column if end == '{j}' else column + end}={column}{end}:{unit}" for end in ends)
        for unit in ("deg", "rad")
    )
    return Refusal(
        f'{motion.where}: {seen} Expected radians, or the unit stated, as in --columns "{deg}" ({rad} if it is '
        "radians)"
    )
