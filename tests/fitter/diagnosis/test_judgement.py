"""What is simulated of a model, and of one that no masses can have."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Arm, Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.judgement import simulated
from fitter.diagnosis.motion import Motion, run_of
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def motion() -> Motion:
    trials = to_trials(swings((), trials=2, seed=3), cutoff_hz=25.0)
    return run_of(pendulum(), trials[:1], trials[1:], thin=False)[-1]


def with_inertia(inertia: float) -> Arm:
    """Return the pendulum with another inertia about its axis [kg m^2]."""
    (joint,) = pendulum().joints
    link = replace(joint.link, inertia_kg_m2=(0.0, 0.0, inertia, 0.0, 0.0, 0.0))
    return replace(pendulum(), joints=(replace(joint, link=link),))


def test_the_right_arm_follows_the_measured_angles(motion):
    assert np.abs(simulated(pendulum(), motion) - motion.trial.q).max() < 0.05


def test_an_arm_of_negative_inertia_goes_nowhere(motion):
    angles = simulated(with_inertia(-0.1), motion)
    np.testing.assert_array_equal(angles[0], motion.trial.q[0])
    assert np.all(np.isinf(angles[1:]))


def test_a_rotor_may_make_up_for_it(motion):
    (joint,) = pendulum().joints
    inertia = joint.link.inertia_kg_m2[2]
    rotor = Effect("rotor_inertia", {"inertia_kg_m2": inertia + 0.1}, joints=(1,))
    angles = simulated(replace(with_inertia(-0.1), effects=(rotor,)), motion)
    np.testing.assert_allclose(angles, simulated(with_inertia(inertia), motion), atol=1e-6)


def test_what_a_joint_weighs_that_never_moves_does_not_matter(motion):
    held = replace(motion, stuck=np.ones_like(motion.stuck))
    assert np.all(np.isfinite(simulated(with_inertia(-0.1), held)))
