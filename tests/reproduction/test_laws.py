"""Rows of Tables 4 and 5."""

import numpy as np
import pytest

from arm.simulation import simulate
from fitter.data.trial import Trial
from fitter.report.published import TRUE
from reproduction.bench_data import true_arm
from reproduction.laws import Gains, angle_error


def test_a_motion_of_the_same_arm_has_no_error():
    arm = true_arm()
    ref = np.full((100, 2), 0.3)
    m = simulate(arm, ref, 0.0025, np.zeros(2))
    trial = Trial("m", m.t, 0.0025, m.q, m.dq, m.ddq, m.tau, m.ref)
    assert angle_error(arm, [trial]).worst < 1e-6


def test_an_arm_whose_law_takes_more_inertia_than_there_is_ran_away():
    trial = Trial("m", np.zeros(2), 0.01, *np.zeros((3, 2, 2)))
    unstable = Gains("pda", 9.5, -9.5, 100.0, tuple(TRUE)).drive(true_arm())
    error = angle_error(unstable, [trial])
    assert error.cells() == ("ran away", "ran away")
    assert error.document() == {"mean": None, "max": None}


@pytest.mark.parametrize(("kv", "ka", "labels"), [(None, None, ("8", "–", "–")), (-2.0, 0.5, ("8", "-2", "0.5"))])
def test_a_gain_that_the_law_has_not_is_a_dash(kv, ka, labels):
    assert Gains("p", 8.0, kv, ka, ()).labels == labels
