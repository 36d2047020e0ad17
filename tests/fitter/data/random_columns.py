"""Random columns of two joints on a uniform grid."""

import numpy as np

from fitter.data.motions import Measured
from fitter.data.resample import Uniform

DT_S = 0.002
N = 1000
CLOCK = DT_S * np.arange(N)
Q, DQ, DDQ, TAU = np.random.default_rng(0).normal(size=(4, N, 2)).cumsum(axis=1)


def uniform(**columns):
    return Uniform(Measured("run", "run.csv", 0, CLOCK, columns, role="learn"), DT_S, 7.0)
