"""Time in milli-, micro- or nanoseconds where seconds are expected."""

import numpy as np

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import rate_ratio, turning
from fitter.data.plausibility.refusal import Refusal
from protocol.tables.magnitude import JOINT_SPEED, RATE_HZ, SLIDE_SPEED, likely
from protocol.tables.turning import top_speeds

_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_NAMES = {"ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}
#: A given velocity agrees with the slope of its angle within this factor, whatever filter either has passed.
_AGREES = 1.5


def look(motion: Measured, arm: Arm) -> Measured:
    """Return the motion, or refuse it where its time is not in seconds.

    Raises
    ------
    Refusal
        With the likely unit.
    """
    if "t" in motion.stated or len(motion.t) < 3 or "q" not in motion.columns:
        return motion
    step_s = float(np.median(np.diff(motion.t)))
    ratios = rate_ratio(motion, "q", "dq")
    if ratios is not None and np.isfinite(ratios).any():
        ratio = float(np.nanmedian(np.abs(ratios)))
        for unit, scale in _UNITS.items():
            if unit != "s" and 1.0 / _AGREES < ratio * scale < _AGREES:
                raise _refusal(motion, unit, f"dq is {ratio:.4g} times the slope of q over t")
        return motion
    speeds = top_speeds(motion.t, motion.columns["q"])
    turns = turning(arm)

    def log_likelihood(scale: float) -> float:
        sizes = [
            (JOINT_SPEED if turn else SLIDE_SPEED).log_likelihood(speed / scale)
            for turn, speed in zip(turns, speeds, strict=True)
            if speed > 0.0
        ]
        return RATE_HZ.log_likelihood(1.0 / (step_s * scale)) + (max(sizes) if sizes else 0.0)

    found = likely({unit: log_likelihood(scale) for unit, scale in _UNITS.items()}, "s")
    if found is None:
        return motion
    j = int(np.argmax(speeds))
    what = "rad/s" if turns[j] else "m/s"
    seen = f"a sample comes every {step_s:.4g} s and joint {j + 1} moves at {speeds[j]:.2g} {what}"
    raise _refusal(motion, found, seen)


def _refusal(motion: Measured, unit: str, seen: str) -> Refusal:
    counts, rate = "", ""
    if np.all(np.diff(motion.t) == 1.0):
        counts, rate = ", or a sample's number", ', or the rate of its samples, as in --columns "t=" --rate-hz 500'
    return Refusal(
        f"{motion.where}: {seen}: is t in {_NAMES[unit]}{counts}? Expected seconds, or its unit stated, as in "
        f'--columns "t=t:{unit}" (t=t:s if it is seconds){rate}'
    )
