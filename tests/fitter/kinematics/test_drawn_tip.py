"""What draws make of a geometry is what fits of the draws make of it."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.kinematics import sensor_positions
from fitter.data.measured_tip import measured_tip
from fitter.data.trial import Trial
from fitter.kinematics.drawn_tip import drawn_geometry
from fitter.kinematics.geometry_fit import fit_kinematics
from tracking.model.draws import Draws

N_DRAW = 3


@pytest.fixture(scope="module")
def trials():
    arm, rng, found = load_arm("dd-arm"), np.random.default_rng(0), []
    for motion in motions(arm, Bench(rate_hz=250.0, learning=3, evaluating=0), seed=0):
        points = sensor_positions(arm, motion.q)
        t, begin = motion.t, points[0].copy()
        tip = measured_tip(arm, motion.q, points - begin)
        drift = rng.normal(0.0, 1e-4, (N_DRAW, 1, 2)) * np.sin(t)[:, None]
        slide = rng.normal(0.0, 1e-4, (N_DRAW, 1, 1, 3)) * (t**2)[:, None, None]
        seen = (points - begin)[None, :, [arm.sensor_index(arm.tip.sensor)]] + slide
        draws = Draws(motion.q + drift, motion.dq + 0.0 * drift, motion.ddq + 0.0 * drift, seen)
        found.append(Trial("bench", t, float(t[1]), motion.q, motion.dq, motion.ddq, tip=tip, draws=draws))
    return found


def moved(arm, trial, b):
    points = np.zeros((len(trial.q), len(arm.sensors), 3))
    points[:, arm.sensor_index(arm.tip.sensor)] = trial.draws.points[b, :, 0]
    return replace(trial, q=trial.draws.q[b], tip=measured_tip(arm, trial.draws.q[b], points), draws=None)


def test_they_agree_to_first_order(trials):
    arm = load_arm("dd-arm")
    names = ("a1", "a2")
    options = {"about": "rest", "angle_noise": None, "fixed": {"alpha2": 0.0, "beta2": 0.0, "theta_offset2": 0.0}}
    fit = fit_kinematics(arm, trials, **options)
    which = np.array([1, 4, 6])  # a1, theta_offset1, a2
    found = drawn_geometry(arm, fit.arm, which, trials)
    for b in range(N_DRAW):
        again = fit_kinematics(arm, [moved(arm, trial, b) for trial in trials], **options)
        change = [again.parameters[name].value - fit.parameters[name].value for name in names]
        np.testing.assert_allclose(found.departures[b].ravel()[[1, 6]], change, rtol=0.1, atol=2e-5)


def test_without_draws_there_is_nothing_to_say(trials):
    arm = load_arm("dd-arm")
    bare = [replace(trials[0], draws=None), *trials[1:]]
    assert drawn_geometry(arm, arm, np.array([1]), bare) is None
