"""What may hold a joint is as large as what was seen to, or as its friction."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Control, Effect, Friction
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.holding_torque import holding_sizes
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from fitter.diagnosis.whitening import inner_rests
from tests.fitter.pendulum import pendulum

DT_S, LAG_S, COULOMB = 0.002, 0.004, 0.02


@pytest.fixture(scope="module")
def starts():
    """Return starts from rest at a jump of the target, in the plane; the drive lags by 4 ms."""
    arm, rng = pendulum(), np.random.default_rng(0)
    joint = replace(arm.joints[0], friction=Friction(0.05, COULOMB, 0.0))
    arm = replace(arm, joints=(joint,), gravity_m_s2=(0.0, 0.0, 0.0), control=Control("pd", (4.0,), (-6.0,)))
    lagging = replace(arm, effects=(Effect("actuator_lag", {"time_constant_s": LAG_S}, joints=(1,)),))
    t, motions = np.arange(1500) * DT_S, []
    for k in range(6):
        ref = np.where(t < 0.6, 0.0, rng.uniform(0.5, 1.0))[:, None]
        q = simulate(lagging, ref, DT_S, ref[0]).q + 1e-4 * rng.normal(size=ref.shape)
        motions.append(Measured(f"start {k + 1}", "test", 0, t, {"q": q, "ref": ref}))
    trials = to_trials(motions, cutoff_hz=30.0)
    return regression_of(arm, run_of(arm, trials[:4], trials[4:]))


def test_what_was_seen_to_hold_limits_what_may_hold(starts):
    """The jump asks for 2 to 4 N m; the joint was never held by more than friction."""
    for size in starts.weighting.holding.values():
        assert np.all((size > COULOMB) & (size < 10.0 * COULOMB))


def test_a_joint_that_never_rests_for_long_is_held_by_little_more_than_friction(starts):
    moving = [replace(motion, stuck=np.zeros_like(motion.stuck)) for motion in starts.motions]
    x = starts.solve(Model(), starts.learning)
    for size in holding_sizes(starts.equations, starts.weighting, Model(), x, moving).values():
        assert np.all((size > 2.0 * COULOMB) & (size < 8.0 * COULOMB))
    denied = Equations(starts.arm, starts.weighting, ("fc",))
    for size in holding_sizes(denied, denied.weighting, Model(), x[:-1], moving).values():
        assert np.all(np.isinf(size))  # nothing tells of friction


def test_friction_that_grows_with_the_load_may_hold_as_much(starts):
    """A joint that has just begun to move is taken for stuck, and its friction counts already."""
    (load,) = (h for h in hypotheses(1, (), driven=True) if h.kind.name == "load_friction")
    model = Model().plus(load, np.zeros(0))
    x = np.append(starts.solve(Model(), starts.learning), 0.3)
    for motion in starts.motions:
        at_rest = motion.stuck[:, 0]
        size = holding_sizes(starts.equations, starts.weighting, model, x, starts.motions)[motion.number][:, 0]
        assert np.all(size[at_rest] >= 2.0 * 0.3 * np.abs(motion.u[at_rest, 0]))


def test_a_start_tells_of_a_lag_unless_anything_might_hold(starts):
    (lag,) = (h for h in hypotheses(1, (), driven=True) if h.kind.name == "actuator_lag")
    found = fitted(starts, Model().plus(lag, np.array([0.002])))
    assert found.model.psi[0][0] == pytest.approx(LAG_S, rel=0.15)
    anything = starts.weighted_by(replace(starts.weighting, holding={}))
    gains = [
        1.0 - fitted(one, found.model, refine=False).squares.sum() / fitted(one, Model()).squares.sum()
        for one in (starts, anything)
    ]
    assert gains[0] > 2.0 * gains[1]


def test_the_inside_of_a_rest_is_far_from_its_ends():
    stuck = np.zeros(1000, dtype=np.bool_)
    stuck[100:400], stuck[500:600] = True, True
    assert inner_rests(stuck, 0.002) == [slice(130, 370)]
