"""Drives are compared by the noise they let through, whatever stands beside them."""

from types import SimpleNamespace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.drive_hypotheses import Delay, Gain, Lag, Limit
from fitter.diagnosis.drive_noise import let_through
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.payload import Payload
from tests.fitter.diagnosis.two_joints import regression_of_two

#: As late, slow or strong as a drive hardly is: without it the equations fit badly.
DRIVES = {
    "actuator_delay": (Delay, 0.03),
    "actuator_lag": (Lag, 0.03),
    "gain_error": (Gain, 0.5),
}


@pytest.fixture(scope="module")
def late():
    """Return the equations of a run whose drive is 24 ms late."""
    return regression_of_two(Effect("actuator_delay", {"delay_s": 0.024}, joints=(1,)))


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("beside", ["payload", "coulomb_asymmetry", "torque_offset"])
def test_a_cause_of_no_size_changes_nothing(late, drive, beside):
    made, psi = DRIVES[drive]
    alone = Model().plus(made(catalogue()[drive], (0,)), np.array([psi]))
    other = (
        Payload(catalogue()[beside], frozenset({1}))
        if beside == "payload"
        else JointHypothesis(catalogue()[beside], 1)
    )
    both = alone.plus(other, np.zeros(0))
    x = late.solve(alone, late.learning)
    with_none = np.append(x, np.zeros(other.n_column))
    np.testing.assert_allclose(late.scale(both, with_none), late.scale(alone, x), rtol=1e-9)
    np.testing.assert_allclose(late.squares(both, with_none), late.squares(alone, x), rtol=1e-9)


def test_a_torque_of_which_half_passes_lets_a_quarter_of_the_noise_through():
    asked, passed = SimpleNamespace(u=np.ones((9, 1)), stuck=np.zeros((9, 1), dtype=bool)), 0.5 * np.ones((9, 1))
    np.testing.assert_allclose(let_through([SimpleNamespace(u=passed)], [asked]), 0.25)


def test_a_limit_that_is_never_reached_lets_all_through(late):
    model = Model().plus(Limit(catalogue()["torque_saturation"], (0,)), np.array([1e3]))
    hypotheticals = [late.hypothetical(model, motion) for motion in late.learning]
    np.testing.assert_array_equal(let_through(hypotheticals, late.learning), 1.0)
