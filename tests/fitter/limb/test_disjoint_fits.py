"""Which trials count as disjoint."""

from dataclasses import replace

import numpy as np

from benchmarks.simulated_people.person import person
from fitter.limb.limb_calibration import calibrate


def test_a_static_trial_says_nothing_by_itself():
    truth = person("human-leg-right", trials=2, n=200, seed=7)
    still = truth.recordings[1]
    still = replace(still, positions=np.tile(still.positions[:1], (len(still.positions), 1, 1)))
    fit = calibrate([truth.recordings[0], still], truth.marker_set, "human-leg-right", fit_frames=150)
    assert len(fit.errors.apart) == 2  # the halves of the trial that moves
    assert fit.errors.apart_m("centres", "hip_right") < 5e-3
