"""Having a tracker's kernels compiled before the first sample counts."""

import numpy as np

from arm.accelerometer import specific_force
from arm.model import Arm, Floats
from limbcal.compilation import said_when_compiling
from tracking.tracker import Tracker

#: A rest until the tracker takes it on trust no more and has recognised it, a gap, a rest again and, for the
#: second half of it, a jump that contradicts the arm for so long that a filter asks what its model lacks [s].
_REST_S, _GAP_S, _AFTER_S = 0.6, 0.02, 2.0
#: Noise of the readings, a usual sensor's, and a jump that nobody takes for noise [m/s^2].
_NOISE_M_S2, _JUMP_M_S2 = 0.02, 3.0
#: The same noise of a gyroscope [rad/s].
_NOISE_RAD_S = 0.01


def warm_up(tracker: Tracker, arm: Arm, rate_hz: float, initial_q_rad: Floats | None) -> None:
    """Take a tracker, which is of no use afterwards, through all that can happen.

    Parameters
    ----------
    tracker : Tracker
        Like the one that will follow the arm.
    arm : Arm
    rate_hz : float
    initial_q_rad : (n_joint,) or None
        Where it takes the arm to rest; zero with None.
    """
    q = (np.zeros(arm.n_joint) if initial_q_rad is None else initial_q_rad)[None]
    felt = specific_force(arm, q, np.zeros_like(q), np.zeros_like(q))[0]
    rest = np.ravel([s.scale for s in arm.sensors]) * felt.ravel() + np.ravel([s.bias_m_s2 for s in arm.sensors])
    rng = np.random.default_rng(0)
    before, after = (round(seconds * rate_hz) + 1 for seconds in (_REST_S, _AFTER_S))
    readings = rest + _NOISE_M_S2 * rng.standard_normal((before + after, len(rest)))
    readings[before + after // 2 :, ::3] += _JUMP_M_S2
    turning = _NOISE_RAD_S * rng.standard_normal((before + after, arm.n_channel - len(rest)))  # of gyroscopes
    readings = np.hstack([readings, turning])
    with said_when_compiling("limbd"):
        tracker.push(0, readings[:before])
        tracker.gap(round(_GAP_S * rate_hz))
        tracker.push(round(1e9 * (_REST_S + _GAP_S)), readings[before:])
        tracker.flush()
