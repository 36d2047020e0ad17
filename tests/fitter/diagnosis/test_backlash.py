"""By how much a link's angle differs from its motor's."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from fitter.data.trial import Trial
from fitter.diagnosis.backlash import BacklashPath
from fitter.diagnosis.contacts import Motor
from fitter.diagnosis.free_link import FreeLink
from fitter.diagnosis.link_coasting import Coasting, coasting

DT = 0.002
T = np.arange(1000) * DT


@pytest.mark.parametrize("gap", [1e-6, 0.0015, 0.05])
def test_a_link_is_never_further_from_its_motor_than_half_the_gap(gap):
    """A motor that creeps for long by a torque that drowns in noise takes its link along."""
    rng = np.random.default_rng(2)
    shaking = 2e-4
    motor = 0.2 * (1.0 - np.exp(-T / 0.4)) + shaking * rng.normal(size=len(T))
    torque = np.where(T < 0.3, -5e-3, np.where(T > 1.7, 5e-3, 0.0)) + 1e-3 * rng.normal(size=len(T))
    link = FreeLink(T, np.ones(len(T)), np.zeros(len(T)), 0.0, 0.0, 0.0)
    found = coasting(Motor(motor, torque, (shaking, 1e-3), [], link, DT))
    assert np.abs(found.bridge).max() > 0.005
    play = BacklashPath(replace(found, variance=np.zeros(len(T))), shaking, cast(Trial, None), 0, 1)
    off = play.off(gap)
    assert np.abs(off).max() <= 0.5 * gap + 4.0 * shaking


def test_of_a_gap_that_is_small_beside_a_bridges_error_the_link_follows_its_motor():
    """The mean of a link that is uniform within the gap and of a bridge, each weighted by its variance."""
    gap, shaking = 3e-4, 2e-4
    found = Coasting(np.full(3, 2e-4), np.array([0.0, 1.0, 1e6]), np.zeros(3))
    play = BacklashPath(found, shaking, cast(Trial, None), 0, 1)
    within = gap**2 / 12.0
    expected = 2e-4 * np.array([1.0, within / (within + shaking**2), within / (within + 1e6 * shaking**2)])
    np.testing.assert_allclose(play.off(gap), expected)
