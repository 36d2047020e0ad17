"""Friction that drifts is the regressor's own, growing."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.diagnosis.diagnosis import diagnose
from fitter.diagnosis.in_friction import FrictionDrift
from fitter.diagnosis.model import Model
from tests.fitter.diagnosis.test_loads import regression_of
from tests.fitter.pendulum import pendulum, swings

DRIFT = Effect("thermal_drift", {"rate_1_s": 0.05}, joints=(1,))


def test_the_columns_of_friction_grow_and_no_others():
    regression = regression_of(DRIFT)
    motion = regression.motions[2]
    plain = regression.view(Model(), motion)
    drifting = FrictionDrift(catalogue()["thermal_drift"], (0,)).act(plain, np.array([0.05]))
    kept = regression.equations.independent(regression.arm)
    was, is_now = plain.base(kept), drifting.base(kept)
    friction = kept >= 10
    grown = (1.0 + 0.05 * motion.t)[:, None, None]
    np.testing.assert_allclose(is_now[..., friction], was[..., friction] * grown)
    np.testing.assert_array_equal(is_now[..., ~friction], was[..., ~friction])


def test_its_rate_is_found():
    motions = swings((DRIFT,), trials=8)
    (cause,) = diagnose(pendulum(), motions[:4], motions[4:]).finding.causes
    rate = cause.parameters["rate_1_s"]
    assert (cause.effect, cause.joints) == ("thermal_drift", (1,))
    assert rate.value == pytest.approx(0.05, abs=3.0 * rate.std)
