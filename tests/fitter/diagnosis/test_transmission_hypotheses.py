"""Between motor and link: whose motion friction brakes."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion, as_measured
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from fitter.diagnosis.transmission_hypotheses import Backlash, Elasticity
from tests.fitter.pendulum import pendulum, swings

STIFF, DAMPED = 40.0, 0.8


@pytest.fixture(scope="module")
def motions() -> list[Motion]:
    soft = Effect("joint_elasticity", {"stiffness_N_m_rad": STIFF, "damping_N_m_s": DAMPED}, joints=(1,))
    trials = to_trials(swings((soft,), trials=8, seed=3), cutoff_hz=25.0)
    return run_of(pendulum(), trials[:6], trials[6:])


def test_friction_follows_the_link_where_motor_and_link_part(motions):
    spring = Elasticity(catalogue()["joint_elasticity"], (0,))
    psi = np.array([1.0 / STIFF, DAMPED / STIFF])
    apart = same = 0
    for motion in motions:
        hypothetical = spring.act(as_measured(motion, pendulum()), psi)
        sure = ~motion.stuck[:, 0] & (np.abs(hypothetical.dq[:, 0]) > 0.1)
        np.testing.assert_array_equal(np.sign(hypothetical.direction[sure, 0]), np.sign(hypothetical.dq[sure, 0]))
        apart += np.sum(hypothetical.direction[sure, 0] * motion.direction[sure, 0] < 0.0)
        same += np.sum(hypothetical.direction[sure, 0] * motion.direction[sure, 0] > 0.0)
        assert not np.any(hypothetical.direction[motion.stuck])
    assert 0 < apart < same


def test_spring_and_friction_behind_it_come_back(motions):
    regression = regression_of(pendulum(), motions)
    spring = Elasticity(catalogue()["joint_elasticity"], (0,))
    start = min(
        (fitted(regression, Model().plus(spring, psi), refine=False) for psi in spring.starts(motions)),
        key=lambda one: float(one.squares.sum()),
    )
    found = fitted(regression, start.model)
    numbers = estimates(regression, found)
    for name, true in (("stiffness_N_m_rad", STIFF), ("damping_N_m_s", DAMPED)):
        number = numbers.effects[0][name]
        assert abs(number.value - true) < 4.0 * number.std < true
    friction = dict(zip(numbers.base.names, zip(numbers.values, numbers.std, strict=True), strict=True))
    for name, true in (("D1", 0.3), ("fc1", 0.05)):
        value, std = friction[name]
        assert abs(value - true) < 4.0 * std < true


def test_a_stiff_spring_changes_no_direction(motions):
    spring = Elasticity(catalogue()["joint_elasticity"], (0,))
    hypothetical = as_measured(motions[0], pendulum())
    stiff = spring.act(hypothetical, np.array([1e-7, 1e-5]))
    fast = np.abs(motions[0].speed[:, 0]) > 0.1
    np.testing.assert_allclose(stiff.direction[fast], hypothetical.direction[fast], atol=0.05)


def test_while_its_motor_may_be_anywhere_in_a_play_a_links_motion_is_guessed(motions):
    play = Backlash(catalogue()["backlash"], (0,))
    hypotheticals = [as_measured(motion, pendulum()) for motion in motions]
    assert not any(hypothetical.guessed.any() for hypothetical in hypotheticals)
    guessed = np.concatenate([play.act(hypothetical, np.array([0.02])).guessed for hypothetical in hypotheticals])
    pulled = np.concatenate([np.abs(motion.u[:, 0]) for motion in motions])
    assert 0.0 < guessed.mean() < 0.5
    assert np.median(pulled[guessed]) < 0.5 * np.median(pulled[~guessed])


@pytest.mark.parametrize("stiff", [8e3, 9e4])
def test_a_stiff_spring_is_begun_with_near_its_compliance(stiff):
    """A start of more than twice the true compliance fits worse than none."""
    effect = Effect("joint_elasticity", {"stiffness_N_m_rad": stiff, "damping_N_m_s": 0.002 * stiff}, joints=(1,))
    trials = to_trials(swings((effect,), trials=4, seed=3), cutoff_hz=25.0)
    some = run_of(pendulum(), trials[:3], trials[3:])
    regression = regression_of(pendulum(), some)
    spring = Elasticity(catalogue()["joint_elasticity"], (0,))
    begun = [fitted(regression, Model().plus(spring, psi), refine=False) for psi in spring.starts(some)]
    assert min(float(one.squares.sum()) for one in begun) < float(fitted(regression, Model()).squares.sum())
