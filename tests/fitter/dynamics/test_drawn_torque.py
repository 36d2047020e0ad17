"""What draws make of a fit is what fits of the draws make of it."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from fitter.data.trial import Trial
from fitter.dynamics.drawn_torque import drawn_dynamics
from fitter.dynamics.fit import fit_dynamics
from fitter.kinematics.tip_basis import geometry_of
from tracking.model.draws import Draws

N_DRAW = 3


def drawn(motion, rng):
    """Return a trial whose motion wanders slowly, and draws that wander otherwise."""
    t, n = motion.t, motion.q.shape[1]
    waves = rng.normal(0.0, 1e-4, (N_DRAW, n))[:, None] * np.sin(2.0 * t)[:, None]
    q, dq, ddq = motion.q + waves, motion.dq + 2.0 * waves, motion.ddq - 4.0 * waves
    draws = Draws(q, dq, ddq, np.zeros((N_DRAW, len(t), 1, 3)))
    return Trial("bench", t, float(t[1]), motion.q, motion.dq, motion.ddq, draws=draws)


@pytest.fixture(scope="module")
def trials():
    rng = np.random.default_rng(0)
    bench = Bench(rate_hz=250.0, learning=3, evaluating=0)
    return [drawn(motion, rng) for motion in motions(load_arm("dd-arm"), bench, seed=0)]


def test_they_agree_to_first_order(trials):
    arm = load_arm("dd-arm")
    geometries = np.repeat(geometry_of(arm)[None], N_DRAW, axis=0)
    geometries[:, 0, 1] += [1e-4, -1e-4, 0.0]
    fit = fit_dynamics(arm, trials, method="least-squares", examine=False)
    found = drawn_dynamics(fit, arm, trials, geometries)
    for b in range(N_DRAW):
        moved = [
            replace(trial, q=trial.draws.q[b], dq=trial.draws.dq[b], ddq=trial.draws.ddq[b]) for trial in trials
        ]
        other = arm.with_joints(a_m=geometries[b, :, 1])
        again = fit_dynamics(other, moved, method="least-squares", examine=False)
        change = np.array([again.parameters[n].value - fit.parameters[n].value for n in fit.base.names])
        identifiable = np.isin(fit.problem.free, again.problem.free)  # joint 1 hardly turns back: fc1 barely is
        assert np.count_nonzero(identifiable) >= 7
        np.testing.assert_allclose(
            found.departures[b][identifiable], change[fit.problem.free][identifiable], rtol=0.1, atol=3e-5
        )
    assert (found.residual_power >= 0.0).all()


def test_a_fit_takes_them_over(trials):
    fit = fit_dynamics(load_arm("dd-arm"), trials, method="least-squares", examine=False)
    assert fit.freedom == N_DRAW
    assert all(p.freedom == N_DRAW for name, p in fit.parameters.items() if name in fit.base.names)


def test_without_draws_there_is_nothing_to_say(trials):
    bare = [replace(trials[0], draws=None), *trials[1:]]
    fit = fit_dynamics(load_arm("dd-arm"), bare, method="least-squares", examine=False)
    assert fit.freedom != N_DRAW
    assert drawn_dynamics(fit, load_arm("dd-arm"), bare, None) is None
