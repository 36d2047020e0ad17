"""Which way is up."""

import numpy as np

from arm.model import Arm
from playback.trajectory import Floats


def upward(arm: Arm) -> Floats:
    """Return the direction against gravity in the base frame, (3,); z where nothing pulls."""
    pull = np.array(arm.gravity_m_s2, dtype=float)
    strength = float(np.linalg.norm(pull))
    return np.array([0.0, 0.0, 1.0]) if strength < 1e-9 else np.asarray(-pull / strength)
