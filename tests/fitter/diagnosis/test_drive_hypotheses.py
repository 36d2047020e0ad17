"""Torque that comes late or slowly, against closed forms."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from arm.effects.catalogue import catalogue
from arm.model import Effect
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.drive_hypotheses import Lag, Limit, _shifted, delayed, lagging
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import as_measured
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings

DT = 0.002


@given(st.floats(0.0, 0.08))
def test_a_delayed_sine_is_a_sine_that_is_late(delay):
    t = np.arange(1000) * DT
    late = delayed(np.sin(7.0 * t), delay, DT)
    after = (t > delay + 3 * DT) & (t < t[-1] - 3 * DT)  # the last samples' curvature is not known
    np.testing.assert_allclose(late[after], np.sin(7.0 * (t - delay))[after], atol=1e-6)


@given(st.floats(0.001, 0.2))
def test_a_lagging_ramp_follows_by_the_time_constant(T):
    t = np.arange(2000) * DT
    followed = lagging(3.0 * t, T, DT)
    np.testing.assert_allclose(followed, 3.0 * (t - T * (1.0 - np.exp(-t / T))), atol=1e-9)


def test_what_does_not_change_is_not_changed():
    constant = np.full(50, 1.7)
    np.testing.assert_allclose(delayed(constant, 0.01, DT), 1.7)
    np.testing.assert_allclose(lagging(constant, 0.01, DT), 1.7)


def test_a_torque_is_made_anew_only_where_something_changes_it():
    trials = to_trials(swings((), trials=2, seed=1), cutoff_hz=25.0)
    lag = Lag(catalogue()["actuator_lag"], (0,))
    one, other = (as_measured(motion, pendulum()) for motion in run_of(pendulum(), trials[:1], trials[1:]))
    at, further = np.array([0.02]), np.array([0.03])
    known = lag.act(one, at).u
    lag.act(other, at)
    assert lag.act(replace(one, q=one.q + 0.1), at).u is known
    twice, weaker = replace(one, u=2.0 * one.u), replace(one, factor=one.factor / 2.0)
    for hypothetical, psi in ((one, further), (twice, at), (weaker, at)):
        np.testing.assert_array_equal(
            lag.act(hypothetical, psi).u[:, 0], lagging(hypothetical.u[:, 0], psi[0], one.motion.dt_s)
        )


def test_a_limit_that_is_reached_now_and_then_is_not_weighed_as_if_it_were_a_gain():
    """What is cut off now and then is little of the noise, however much of the torque it is."""
    limit, rng = 28.0, np.random.default_rng(0)
    arm = replace(pendulum(), effects=(Effect("torque_saturation", {"limit_N_m": limit}, joints=(1,)),))
    motions = []
    for one in swings((), trials=6, seed=5):
        moved = simulate(arm, one.columns["ref"], 0.004, one.columns["ref"][0])
        noise = rng.normal(size=(2, len(moved.t), 1))
        measured = {"q": moved.q + 2e-4 * noise[0], "tau": moved.tau + 0.1 * noise[1]}
        motions.append(Measured(one.name, "test", 0, moved.t, measured))
    trials = to_trials(motions, cutoff_hz=25.0)
    regression = regression_of(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    found = fitted(regression, Model().plus(Limit(catalogue()["torque_saturation"], (0,)), np.array([27.0])))
    assert abs(found.model.psi[0][0] - 28.0) < 0.5
    assert found.squares.sum() < 0.3 * fitted(regression, Model()).squares.sum()
    assert 1.0 < regression.scale(found.model, found.x)[0] ** 2 < 1.05


def test_a_limit_that_cuts_off_everything_explains_nothing():
    trials = to_trials(swings((), trials=6, seed=5), cutoff_hz=25.0)
    regression = regression_of(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    limit = Limit(catalogue()["torque_saturation"], (0,))
    nothing = fitted(regression, Model().plus(limit, np.array([1e-3])), refine=False)
    assert nothing.squares.sum() > 10.0 * fitted(regression, Model()).squares.sum()


@given(st.floats(-3.0, 80.0), st.integers(5, 200), st.integers(0, 9))
def test_a_shift_is_that_of_a_cubic_spline(samples: float, n: int, seed: int):
    """Inside; how it goes on beyond its ends is our own."""
    u = np.cumsum(np.random.default_rng(seed).normal(size=n))
    found = _shifted(u, samples)
    assert found.shape == u.shape and np.all(np.isfinite(found))
    inner = np.arange(n)[(np.arange(n) - samples > 15) & (np.arange(n) - samples < n - 16)]
    np.testing.assert_allclose(found[inner], CubicSpline(np.arange(n), u)(inner - samples), atol=1e-6)
