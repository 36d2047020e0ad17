"""Time that is not in seconds is asked about."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.plausibility.refusal import Refusal
from fitter.data.plausibility.time_unit import look
from tests.fitter.data.plausibility.conftest import changed

UNITS = [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("unit", "factor"), UNITS)
def test_each_unit_is_named(arm, clean, seed, unit, factor):
    motion = clean(seed)
    with pytest.raises(Refusal, match=f"clean.csv: .* is t in {unit}"):
        look(replace(motion, t=factor * motion.t), arm)


def test_a_velocity_tells_it_whatever_the_magnitude(arm, clean):
    motion = clean(0, 0.02)
    dq = np.gradient(motion.columns["q"], motion.t, axis=0)
    given = changed(motion, dq=dq)
    assert look(given, arm) is given
    with pytest.raises(Refusal, match="times the slope of q"):
        look(replace(given, t=1e3 * given.t), arm)


def test_a_unit_that_is_stated_is_believed(arm, clean):
    slow = replace(clean(), t=1e3 * clean().t, stated=frozenset({"t"}))
    assert look(slow, arm) is slow
