"""Going through the search for pushes, masses and coasting links on hardly any data, to compile their kernels."""

import numpy as np

from arm.model import Floats
from fitter.diagnosis.free_link import weightless
from fitter.diagnosis.mass_determinants import determinant_slopes, log_determinant, solved_slopes
from fitter.diagnosis.torque.pulses import find_pulses
from fitter.diagnosis.torque.residual_torque import ResidualTorque

_ROWS, _STEP_S, _BAND_HZ = 200, 0.02, 25.0
_NOISE_N_M, _PUSH_N_M = 0.01, 1.0


def warm_up() -> None:
    """Find a push at the first joint of an arm of no interest."""
    t, shape = np.linspace(0.0, _STEP_S * (_ROWS - 1), _ROWS), (_ROWS, 2)
    rng = np.random.default_rng(0)
    r: Floats = _NOISE_N_M * rng.normal(size=shape)
    r[80:100, 0] += _PUSH_N_M
    noises = np.full(2, _NOISE_N_M), np.zeros(2)
    torque = np.stack([np.sin(t), np.cos(t)], axis=1)
    known, friction, turning = np.ones(shape, dtype=np.bool_), *np.zeros((2, *shape))
    find_pulses([ResidualTorque(t, r, known, torque, _BAND_HZ, *noises, friction, turning, ~known)])
    weightless(t).moved(slice(0, _ROWS), r[:, 0], 0.0, 0.0, _STEP_S)
    masses = np.broadcast_to(np.eye(2), (3, 2, 2)).copy()
    log_determinant(masses, np.ones(3))
    solved_slopes(masses, np.ones((3, 2, 2, 1)))
    determinant_slopes(masses, np.ones(3), np.ones((3, 2, 2, 1)))
