"""Angles in degrees where radians are expected."""

import numpy as np

from arm.model import Arm, Floats
from fitter.data.motions import Measured
from fitter.data.plausibility.magnitude import (
    EFFECTIVE_SAMPLES,
    JOINT_RANGE,
    JOINT_SPEED,
    REACH_RATIO,
    WHEEL,
    WHEEL_RANGE,
    likely,
)
from fitter.data.plausibility.motion_sizes import (
    path_lengths,
    reach,
    speed_ratio,
    top_speeds,
    torque_left,
    turning,
)
from fitter.data.plausibility.refusal import Refusal

_DEGREE = np.pi / 180.0
#: A given velocity agrees with the slope of its angle within this factor.
_AGREES = 1.5


def look(motion: Measured, arm: Arm) -> Measured:
    """Return the motion, or refuse it where its angles are not in radians.

    Raises
    ------
    Refusal
        With the likely unit.
    """
    turns = turning(arm)
    if "q" not in motion.columns or len(motion.t) < 3 or not turns.any():
        return motion
    joints = [j for j in np.flatnonzero(turns) if f"q{j + 1}" not in motion.stated]
    if not joints:
        return motion
    ratios = speed_ratio(motion)
    if ratios is not None and np.isfinite(ratios[joints]).any():
        ratio = float(np.nanmedian(ratios[joints]))
        for column, scale in (("q", 1.0 / _DEGREE), ("dq", _DEGREE)):
            if 1.0 / _AGREES < ratio * scale < _AGREES:
                other = "dq" if column == "q" else "q"
                seen = f"the slope of q is {1.0 / ratio:.4g} times dq: is {column} in degrees, {other} not?"
                raise _refusal(motion, column, seen)
    q = motion.columns["q"][:, joints]
    ranges, speeds = np.ptp(q, axis=0), top_speeds(motion.t, q)
    weight = {"rad": _by_size(ranges, speeds), "deg": _by_size(ranges * _DEGREE, speeds * _DEGREE)}
    for unit, scale in (("rad", 1.0), ("deg", _DEGREE)):
        left = torque_left(arm, motion, scale)
        if left is not None:
            weight[unit] -= 0.5 * EFFECTIVE_SAMPLES * np.log(max(left, 1e-6))
        if "tip" in motion.columns and reach(arm) > 0.0:
            travelled = float(np.linalg.norm(path_lengths(motion.columns["tip"])))
            turned = scale * float(path_lengths(q).sum())
            if turned > 0.0:
                weight[unit] += REACH_RATIO.log_likelihood(travelled / turned / reach(arm))
    if likely(weight, "rad") is None:
        return motion
    j = int(np.argmax(ranges))
    seen = f"joint {joints[j] + 1} moves {ranges[j]:.3g} rad to and fro at up to {speeds[j]:.3g} rad/s: degrees?"
    raise _refusal(motion, "q", seen)


def _by_size(ranges: Floats, speeds: Floats) -> float:
    """Return the log likelihood of ranges [rad] and top speeds [rad/s] of joints, of which some may be wheels."""
    total = 0.0
    for span, speed in zip(ranges.tolist(), speeds.tolist(), strict=True):
        if span > 0.0:
            limb = np.log(1.0 - WHEEL) + JOINT_RANGE.log_likelihood(span)
            wheel = np.log(WHEEL) + WHEEL_RANGE.log_likelihood(span)
            total += float(np.logaddexp(limb, wheel)) + JOINT_SPEED.log_likelihood(speed)
    return total


def _refusal(motion: Measured, column: str, seen: str) -> Refusal:
    return Refusal(
        f"{motion.where}: {seen} Expected radians, or the unit stated, as in "
        f'--columns "{column}={column}{{j}}:deg" ({column}={column}{{j}}:rad if it is radians)'
    )
