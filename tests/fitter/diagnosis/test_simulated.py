"""What is simulated of a model, and of one that no masses can have."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Arm, Control, Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.held_out import simulated
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.run import run_of
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
    assert np.abs(simulated(pendulum(), motion, 0.5) - motion.trial.q).max() < 0.05


def test_an_arm_of_negative_inertia_goes_nowhere(motion):
    angles = simulated(with_inertia(-0.1), motion, 0.5)
    np.testing.assert_array_equal(angles[0], motion.trial.q[0])
    assert np.all(np.isinf(angles[1:]))


def test_a_rotor_may_make_up_for_it(motion):
    (joint,) = pendulum().joints
    inertia = joint.link.inertia_kg_m2[2]
    rotor = Effect("rotor_inertia", {"inertia_kg_m2": inertia + 0.1}, joints=(1,))
    angles = simulated(replace(with_inertia(-0.1), effects=(rotor,)), motion, 0.5)
    np.testing.assert_allclose(angles, simulated(with_inertia(inertia), motion, 0.5), atol=1e-6)


def test_what_a_joint_weighs_that_never_moves_does_not_matter(motion):
    held = replace(motion, stuck=np.ones_like(motion.stuck))
    assert np.all(np.isfinite(simulated(with_inertia(-0.1), held, 0.5)))


def test_with_measured_torque_it_starts_anew_from_the_data_every_horizon(motion):
    given = replace(pendulum(), control=Control("measured"))
    trial = replace(motion.trial, tau=motion.u, ref=None)
    driven, wrong = replace(motion, trial=trial), with_inertia(0.3)
    wrong = replace(wrong, control=given.control)
    errors = {}
    for horizon_s in (0.1, 1.0):
        off = np.abs(simulated(wrong, driven, horizon_s) - trial.q)
        stride = round(horizon_s / trial.dt_s)
        first = np.arange(1, len(off) - 1, stride)
        assert np.all(off[first] < 0.02)
        errors[horizon_s] = float(off.mean())
    assert errors[0.1] < 0.2 * errors[1.0]
    assert np.abs(simulated(given, driven, 1.0) - trial.q).max() < 0.05
