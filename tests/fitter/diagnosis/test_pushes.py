"""Pushes as a hypothesis: times that are free, a torque each, and names that tell them apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from fitter.diagnosis.pushes import Pushes, _box

KIND = catalogue()["external_push"]


class Grid:
    """The instants of a motion, which is all that a push's column needs."""

    dt_s = 0.01
    t = np.arange(200) * dt_s


@given(start=st.floats(0.1, 1.0), duration=st.floats(0.02, 0.8))
def test_a_push_has_the_impulse_of_its_duration(start, duration):
    assert _box(Grid, start, duration).sum() * Grid.dt_s == pytest.approx(duration, abs=0.5 * Grid.dt_s)


def test_each_of_several_has_its_own_numbers():
    pushes = Pushes(KIND, 0, np.array([[1.0, 0.2], [3.0, 0.4]]), free=True)
    (psi,) = pushes.starts([])
    assert np.all(pushes.low < psi) and np.all(psi < pushes.high)
    assert pushes.numbers(psi, np.array([5.0, -6.0])).tolist() == [1.0, 0.2, 5.0, 3.0, 0.4, -6.0]
    assert pushes.names[:3] == ("start_s_1", "duration_s_1", "torque_N_m_1") and len(pushes.units) == 6
    assert Pushes(KIND, 0, np.array([[1.0, 0.2]])).names == ("start_s", "duration_s", "torque_N_m")
