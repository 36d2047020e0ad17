"""Going through the search for pushes, and masses, on hardly any data, so that their kernels are compiled."""

import numpy as np

from fitter.diagnosis.mass_determinants import log_determinant, solved_slopes
from fitter.diagnosis.torque.pulses import find_pulses
from fitter.diagnosis.torque.residual_torque import ResidualTorque

_ROWS, _STEP_S, _BAND_HZ = 200, 0.02, 25.0
_NOISE_N_M, _PUSH_N_M = 0.01, 1.0


def warm_up() -> None:
    """Find a push at the first joint of an arm of no interest."""
    t, shape = _STEP_S * np.arange(_ROWS), (_ROWS, 2)
    rng = np.random.default_rng(0)
    r = _NOISE_N_M * rng.normal(size=shape)
    r[80:100, 0] += _PUSH_N_M
    noises = np.full(2, _NOISE_N_M), np.zeros(2)
    torque = np.stack([np.sin(t), np.cos(t)], axis=1)
    known, still = np.ones(shape, dtype=np.bool_), np.zeros((2, *shape))
    find_pulses([ResidualTorque(t, np.asarray(r, dtype=np.float64), known, torque, _BAND_HZ, *noises, *still)])
    masses = np.broadcast_to(np.eye(2), (3, 2, 2)).copy()
    log_determinant(masses, np.ones(3))
    solved_slopes(masses, np.ones((3, 2, 2, 1)))
