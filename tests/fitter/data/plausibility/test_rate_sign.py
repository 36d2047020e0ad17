"""Velocities and accelerations that count the other way round than the angles."""

import numpy as np
import pytest

from fitter.data.plausibility.rate_sign import look
from tests.fitter.data.plausibility.conftest import changed


@pytest.fixture
def motion(clean):
    whole = clean(1)
    dq = np.gradient(whole.columns["q"], whole.t, axis=0)
    return changed(whole, dq=dq, ddq=np.gradient(dq, whole.t, axis=0))


def test_rates_of_the_angles_sign_stay(motion, arm):
    assert look(motion, arm) is motion


@pytest.mark.parametrize(("turned", "dropped"), [("dq", {"dq", "ddq"}), ("ddq", {"ddq"})])
def test_a_rate_of_the_other_sign_is_dropped_and_noted(motion, arm, turned, dropped):
    found = look(changed(motion, **{turned: motion.columns[turned] * [1.0, -1.0]}), arm)
    assert set(motion.columns) - set(found.columns) == dropped
    (note,) = found.notes
    assert (note.kind, note.columns, note.row) == ("sign", (f"{turned}2",), 1)


def test_a_rate_that_is_only_noise_is_none_of_another_sign(motion, arm):
    noise = changed(motion, ddq=np.random.default_rng(0).normal(size=motion.columns["q"].shape))
    assert look(noise, arm) is noise
