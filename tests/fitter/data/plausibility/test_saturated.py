"""A torque that stands at its limit does not count, and is said."""

import numpy as np
import pytest

from fitter.data.plausibility.saturated import CONTRADICTED, cut_off, look
from fitter.data.trials import to_trials
from tests.fitter.data.plausibility.conftest import changed


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_every_sample_at_the_limit_is_marked(arm, clean, seed, share):
    motion = clean(seed)
    assert look(motion, arm) is motion
    tau = motion.columns["tau"]
    limit = share * np.abs(tau).max(axis=0)
    found = look(changed(motion, tau=np.clip(tau, -limit, limit)), arm)
    marked = found.columns[CONTRADICTED] > 0.0
    at_limit = np.abs(tau) >= limit
    assert np.mean(marked[at_limit]) > 0.7 and not marked[~at_limit].any()
    assert all("cut off?" in note.text and note.kind == "saturated" for note in found.notes)
    for note in found.notes:
        k = int(np.flatnonzero(marked[:, int(note.columns[0][3:]) - 1])[0])
        assert (note.row, note.from_s) == (motion.first_row + k + 1, motion.t[k])
    (trial,) = to_trials([found])
    assert trial.contradicted is not None and trial.counted.mean() < 1.0


def test_a_peak_that_is_rounded_is_no_limit():
    t = np.arange(0.0, 4.0, 2e-3)
    assert not cut_off(np.round(10.0 * np.sin(2.0 * t), 2)).any()


def test_a_torque_of_steps_is_what_it_is():
    assert not cut_off(np.repeat([0.0, 4.0, -4.0, 2.0, 4.0, -2.0, 0.0], 50)).any()
    assert not cut_off(np.repeat([4.0, -4.0, 4.0, -4.0], 50)).any()
