"""Moments that no body has tell a tilt of gravity that is none."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.bodies import has_bodies
from fitter.diagnosis.in_arm import GravityTilt
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.screening import fitted
from tests.fitter.pendulum import pendulum, swings

FULL = pendulum().gravity_m_s2


@pytest.fixture(scope="module")
def tilted() -> tuple[Regression, Candidate]:
    motions: list[Measured] = swings((), trials=6, seed=2)
    trials, level = to_trials(motions, cutoff_hz=25.0), replace(pendulum(), gravity_m_s2=(0.0, 0.0, -9.81))
    regression = Regression(level, run_of(level, trials[:3], trials[3:]))
    tilt = Model().plus(GravityTilt(catalogue()["gravity_tilt"], ()), np.array(FULL[:2]))
    return regression, fitted(regression, tilt, refine=False)


def test_a_tilt_of_gravity_turns_a_body(tilted: tuple[Regression, Candidate]) -> None:
    regression, found = tilted
    assert has_bodies(regression, found)
    assert has_bodies(regression, fitted(regression, Model()))


def test_a_tilt_of_next_to_none_turns_none(tilted: tuple[Regression, Candidate]) -> None:
    regression, found = tilted
    faint = Model().plus(found.hypothesis, 1e-4 * found.model.psi[-1])
    same = fitted(regression, faint, refine=False)
    assert same.squares.sum() == pytest.approx(found.squares.sum(), rel=1e-3)
    assert not has_bodies(regression, same)
