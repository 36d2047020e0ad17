"""Rests: friction holds a joint, so it is asked for no more there than friction can hold."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.friction_limits import FrictionLimits
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.screening import screen
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.diagnosis.two_joints import regression_of_two

#: Samples at which a joint rests, and at which more is asked of it meanwhile: it is torn away by what it takes.
REST, ASKED = slice(100, 300), slice(100, 200)


def resting(torque_N_m, trials=2):
    """Return a run whose second joint rests for a while under some torque more than it takes to move so."""
    plain = regression_of_two(trials=trials)
    motions = []
    for one in plain.motions:
        stuck, u = np.zeros_like(one.stuck), one.u.copy()
        stuck[REST, 1] = True
        direction = np.where(stuck, 0.0, one.direction)
        still = replace(
            one,
            stuck=stuck,
            direction=direction,
            dq=np.where(stuck, 0.0, one.dq),
            ddq=np.where(stuck, 0.0, one.ddq),
        )
        x = plain.solve(Model(), plain.motions)
        needed = u - plain.equations.residual_torque(Model(), x, still)
        u[REST, 1] = needed[REST, 1]
        u[ASKED, 1] += torque_N_m
        motions.append(replace(still, u=u))
    return regression_of(plain.arm, motions), x


def test_what_friction_can_hold_is_no_residual():
    regression, x = resting(0.0)
    rests = FrictionLimits(regression.equations, regression.motions, 1.0)
    assert sum(len(one) for one in rests.beyond(Model(), x, regression.motions)) > 0
    assert max(float(one.max()) for one in rests.beyond(Model(), x, regression.motions)) < 1.0


def test_more_than_friction_can_hold_is_one_the_larger_the_more_it_is():
    sizes = []
    for torque in (2.0, 4.0):
        regression, x = resting(torque)
        rests = FrictionLimits(regression.equations, regression.motions, 1.0)
        sizes.append(sum(float(one @ one) for one in rests.beyond(Model(), x, regression.motions)))
    assert 0.0 < sizes[0] < sizes[1]


def test_normal_equations_are_those_of_the_limits_that_are_exceeded():
    regression, x = resting(3.0)
    rests = FrictionLimits(regression.equations, regression.motions, 1.0)
    square = sum(float(one @ one) for one in rests.beyond(Model(), x, regression.motions))
    normal = rests.normal(Model(), x, regression.motions)
    assert normal.sum_of_squares(x) == pytest.approx(square, rel=1e-6)
    slope = 2.0 * (normal.gram @ x - normal.rhs)
    for k in range(len(x)):
        step = 1e-6 * (np.arange(len(x)) == k)
        ahead, behind = (
            sum(float(one @ one) for one in rests.beyond(Model(), at, regression.motions))
            for at in (x + step, x - step)
        )
        assert slope[k] == pytest.approx((ahead - behind) / 2e-6, rel=1e-3, abs=1e-3 * np.abs(slope).max())


def test_friction_that_would_not_have_been_overcome_is_a_residual_too():
    regression, x = resting(0.0)
    rests = FrictionLimits(regression.equations, regression.motions, 1.0)
    rough = Model().plus(JointHypothesis(catalogue()["coulomb"], 1), np.zeros(0))
    sizes = [
        sum(float(one @ one) for one in rests.beyond(rough, np.append(x, more), regression.motions))
        for more in (0.0, 8.0)
    ]
    assert sizes[0] < 1.0 < sizes[1]


def test_dry_friction_brakes_where_something_is_lacking():
    plain = regression_of_two(trials=2)
    # A torque along the motion that no base parameter has, but negative dry friction nearly.
    motions = [
        replace(one, u=one.u - 0.8 * np.sign(one.dq) + 0.3 * np.sin(5.0 * one.t)[:, None]) for one in plain.motions
    ]
    regression = regression_of(plain.arm, motions)
    likelihood = TorqueLikelihood(regression, [], screen)
    base = likelihood.base().candidate
    friction = likelihood.regression.equations.friction(Model(), base.x, motions[0])[:, 1]
    assert np.all(friction >= 0.0)
    with likelihood.regression.by_torque_alone():
        free = likelihood.regression.solve(Model(), motions)
    assert np.any(likelihood.regression.equations.friction(Model(), free, motions[0])[:, 1] < 0.0)
