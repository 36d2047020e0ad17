"""Rows that repeat the one before."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.plausibility.repeats import look


@pytest.mark.parametrize("seed", range(3))
def test_a_logger_that_is_twice_as_fast_as_what_it_logs(arm, clean, seed):
    motion = clean(seed)
    assert look(motion, arm) is motion
    held = {role: np.repeat(values[::2], 2, axis=0) for role, values in motion.columns.items()}
    found = look(replace(motion, columns=held), arm)
    (note,) = found.notes
    assert note.kind == "repeated" and len(found.t) < 0.6 * len(motion.t)
    kept = np.isin(motion.t, found.t)
    assert kept[::2].all()


def test_rows_at_rest_repeat_rightly(arm, clean):
    motion = clean()
    q = np.vstack([np.zeros((200, 2)), np.cumsum(np.full((len(motion.t) - 200, 2), 1e-3), axis=0)])
    resting = replace(motion, columns={"q": q})
    assert look(resting, arm) is resting
