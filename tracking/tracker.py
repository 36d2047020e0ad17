"""Choosing what turns accelerations into joint motion."""

from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from arm.model import Arm, Floats
from tracking.dead_reckoning.integrator import Integrator, Zero
from tracking.model.innovation_test import Consistency

if TYPE_CHECKING:
    from tracking.kalman.kalman_filter import KalmanTracker

Method = Literal["filter", "integrate"]
Tracker: TypeAlias = "KalmanTracker | Integrator"


def tracker_of(
    arm: Arm,
    method: Method,
    rate_hz: float,
    initial_q_rad: Floats | None = None,
    frame_rate_hz: float = 1000.0,
    zero: Zero = "each-rest",
) -> Tracker:
    """Return a tracker of the chosen method.

    Parameters
    ----------
    arm : Arm
    method : {"filter", "integrate"}
        The extended Kalman filter, or the paper's double integration.
    rate_hz : float
    initial_q_rad : (n_joint,) or None
        Where the arm rests when tracking begins. With None the filter asks gravity; the integrator takes zero.
    frame_rate_hz : float
    zero : {"each-rest", "first-rest"}
        See `tracking.dead_reckoning.integrator.Integrator`; the filter has no use for it.

    Raises
    ------
    ConfigError
        If the arm's sensors cannot be tracked by this method, or a number makes no sense.
    """
    if method == "filter":
        # It takes filterpy and scipy.stats with it, a second that the paper's method need not wait for.
        from tracking.kalman.kalman_filter import KalmanTracker  # noqa: PLC0415

        return KalmanTracker(arm, rate_hz, initial_q_rad, frame_rate_hz)
    q0 = np.zeros(arm.n_joint) if initial_q_rad is None else initial_q_rad
    return Integrator(arm, rate_hz, q0, frame_rate_hz, zero)


def consistency_of(tracker: Tracker) -> Consistency:
    """Return how well the readings since the last call fit the tracker's claims; the integrator makes none."""
    if isinstance(tracker, Integrator):
        return Consistency(None, 0, 0, False)
    return tracker.consistency()
