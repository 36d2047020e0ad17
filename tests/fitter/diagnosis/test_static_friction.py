"""A hump of friction, or static friction: the motion tells which of them holds a joint."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Control, Effect, Friction
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.conclusion import concluded
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from fitter.diagnosis.static_friction import hump_of, static_frictions
from tests.fitter.diagnosis.searched import searched
from tests.fitter.pendulum import pendulum

DT_S, COULOMB, HEIGHT, WIDTH = 0.002, 0.05, 0.3, 0.06


def sticking(effect):
    """Return the regression of an arm in the plane that creeps to targets and sticks there."""
    arm, rng = pendulum(), np.random.default_rng(0)
    joint = replace(arm.joints[0], friction=Friction(0.1, COULOMB, 0.0))
    arm = replace(arm, joints=(joint,), gravity_m_s2=(0.0, 0.0, 0.0), control=Control("pd", (6.0,), (-5.0,)))
    t, motions = np.arange(2500) * DT_S, []
    for k in range(8):
        swing = 0.4 * np.sin(2.0 * np.pi * rng.uniform(0.4, 0.8) * np.minimum(t, 2.0))
        ref = (swing + rng.uniform(0.08, 0.15) * np.maximum(t - 2.0, 0.0))[:, None]
        motion = simulate(replace(arm, effects=(effect,)), ref, DT_S, ref[0])
        q = motion.q + 1e-4 * rng.normal(size=ref.shape)
        motions.append(Measured(f"{k + 1}", "test", 0, t, {"q": q, "ref": ref}))
    trials = to_trials(motions, cutoff_hz=30.0)
    return regression_of(arm, run_of(arm, trials[:4], trials[4:]))


def held(regression):
    base = fitted(regression, Model())
    return base, static_frictions(regression, base, estimates(regression, base).covariance)


def test_a_hump_that_shows_in_motion_is_told_with_its_width():
    regression = sticking(Effect("stribeck", {"amplitude_N_m": HEIGHT, "velocity_rad_s": WIDTH}, joints=(1,)))
    base, (one,) = held(regression)
    hump = hump_of(regression, base, one)
    assert hump is not None
    assert hump.needed
    assert hump.width == pytest.approx(WIDTH, rel=0.1)


def test_static_friction_is_no_hump():
    regression = sticking(Effect("stiction", {"static_N_m": COULOMB + HEIGHT}, joints=(1,)))
    base, (one,) = held(regression)
    assert hump_of(regression, base, one) is None


def test_no_cause_but_the_one_that_rests_tell():
    regression = sticking(Effect("stiction", {"static_N_m": COULOMB + HEIGHT}, joints=(1,)))
    come_to = concluded(*searched(regression, []))
    assert come_to.verdict == "named"
    assert [one.joint for one in come_to.held] == [0]
    assert not come_to.equals
