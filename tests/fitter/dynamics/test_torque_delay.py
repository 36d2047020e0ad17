"""A torque that comes late is said to, by how much, and one that does not is not."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.dynamics.torque_delay import torque_delay
from tests.fitter.dynamics.test_torque_wiring import ARM, BASE, driven


@pytest.mark.parametrize("seed", range(4))
def test_a_torque_that_is_in_time_raises_no_question(seed):
    assert torque_delay(ARM, BASE, [driven(ARM, seed)]) is None


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("samples", [2, 5, -3])
def test_the_delay_is_found_to_the_sample(seed, samples):
    trial = driven(ARM, seed)
    late = replace(trial, tau=np.roll(trial.tau, samples, axis=0))
    found = torque_delay(ARM, BASE, [late])
    assert found.seconds == pytest.approx(samples * trial.dt_s) and found.residual_share < 0.8
    assert ("late" if samples > 0 else "early") in found.note.text


def test_without_a_torque_nothing_is_late():
    assert torque_delay(ARM, BASE, []) is None
    assert torque_delay(ARM, BASE, [replace(driven(ARM, 0), tau=None)]) is None
