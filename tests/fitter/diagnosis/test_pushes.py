"""Pushes are found where they begin and end, though nobody feels them in a rest."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Effect, Friction
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.pushes import _beside_rests, _placed
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from tests.fitter.pendulum import pendulum

DT_S, LASTS_S = 0.004, 4.0
#: One that soon comes to rest.
ARM = replace(pendulum(), joints=(replace(pendulum().joints[0], friction=Friction(4.0, 1.0, 0.0)),))


def resting(push: dict[str, float]) -> Regression:
    """Return a pendulum that swings, then stands still, and is pushed in its fifth trial."""
    rng = np.random.default_rng(3)
    arm = replace(ARM, effects=(Effect("external_push", push, joints=(1,)),))
    t = np.arange(round(LASTS_S / DT_S)) * DT_S
    motions = []
    for k in range(8):
        swing = rng.uniform(0.5, 0.9) * np.sin(2.0 * np.pi * np.minimum(t, 1.25) * rng.choice([0.6, 1.0, 1.4]))
        ref = swing[:, None]
        q = simulate(arm, ref, DT_S, ref[0], np.zeros(1), t0_s=k * LASTS_S, trial=k + 1).q
        noisy = q + 1e-4 * rng.normal(size=q.shape)
        motions.append(Measured(f"swing {k + 1}", "test", 0, t, {"q": noisy, "ref": ref}))
    trials = to_trials(motions, cutoff_hz=25.0)
    return Regression(ARM, run_of(ARM, trials[:4], trials[4:]))


def test_a_push_after_a_rest_begins_where_it_is_felt():
    start, duration = 4 * LASTS_S + 3.0, 0.3
    regression = resting({"start_s": start, "duration_s": duration, "torque_N_m": 5.0})
    pushed = regression.motions[4]
    before = (pushed.t > start - 0.4) & (pushed.t < start - 0.1)
    assert np.all(pushed.stuck[before, 0])
    base = fitted(regression, Model())
    left = regression.residual(base.model, base.x, pushed).ravel()
    for begun in (start, start - 0.35):  # the same push, but for a rest
        found = _placed(regression, pushed, 0, left, begun, start + duration - begun)
        assert (found.start, found.duration) == pytest.approx((start, duration), abs=0.06)


def test_a_push_that_reaches_into_rests_is_tried_without_them():
    regression = resting({"start_s": 1e3, "duration_s": 0.1, "torque_N_m": 1.0})
    motion = replace(regression.motions[0], stuck=np.zeros_like(regression.motions[0].stuck))
    t, dt_s = motion.t, motion.dt_s
    motion.stuck[50:80, 0] = motion.stuck[120:160, 0] = True
    assert _beside_rests(motion, 0, t[90], 20 * dt_s) == []
    (later,) = _beside_rests(motion, 0, t[60], 40 * dt_s)
    assert later == pytest.approx((t[79], 21 * dt_s))
    (shorter,) = _beside_rests(motion, 0, t[100], 40 * dt_s)
    assert shorter == pytest.approx((t[100], 20 * dt_s))
    assert len(_beside_rests(motion, 0, t[48], 100 * dt_s)) == 2
    assert _beside_rests(motion, 0, t[55], 10 * dt_s) == []  # all of it in one rest
