"""What ends between two samples, behind the filter of a motion's columns."""

from types import SimpleNamespace

import numpy as np
import pytest

from fitter.data.derivatives import lowpass
from fitter.diagnosis.sharp_columns import behind_filter

DT_S, TRIMMED, N, PARTS = 0.004, 50, 600, 20


def motion(step=1, cutoff_hz=20.0):
    trial = SimpleNamespace(t=DT_S * np.arange(N), dt_s=DT_S, cutoff_hz=cutoff_hz, trimmed=TRIMMED)
    return SimpleNamespace(trial=trial, t=3.0 + trial.t[::step], dt_s=step * DT_S)


def area(start_s, end_s):
    return lambda t: np.clip(t, start_s, end_s) - start_s


@pytest.mark.parametrize(
    ("step", "start_s", "end_s"), [(1, 3.9013, 4.2371), (3, 3.9013, 4.2371), (2, 2.9, 3.0507)]
)
def test_it_is_the_same_filtered_on_a_fine_grid(step, start_s, end_s):
    there = motion(step)
    fine_s = DT_S / PARTS
    t = 3.0 + fine_s * np.arange(-TRIMMED * PARTS, (N + TRIMMED) * PARTS)
    inside = ((t >= start_s) & (t < end_s)).astype(float)
    expected = lowpass(inside, fine_s, 20.0)[TRIMMED * PARTS :: PARTS][:N:step]
    found = behind_filter(there, area(start_s, end_s), (start_s, end_s))
    assert found.shape == there.t.shape
    np.testing.assert_allclose(found, expected, atol=6e-3)


def test_far_from_its_ends_nothing_is_filtered():
    there = motion()
    assert np.all(behind_filter(there, area(0.0, 1.0), (0.0, 1.0)) == 0.0)
    np.testing.assert_allclose(behind_filter(there, area(0.0, 9.0), (8.0, 9.0)), 1.0)


def test_unfiltered_columns_have_the_means_over_their_steps():
    found = behind_filter(motion(cutoff_hz=np.inf), area(3.401, 9.0), (3.401, 9.0))
    assert found[99:102] == pytest.approx([0.0, 0.25, 1.0])
