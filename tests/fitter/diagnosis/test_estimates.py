"""What a fitted model becomes as an arm."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.data.trials import to_trials
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.estimates import estimates, significant
from fitter.diagnosis.extended_arm import extended_arm
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression():
    trials = to_trials(swings((), trials=6, seed=2), cutoff_hz=25.0)
    return regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))


def test_numbers_lie_within_their_errors(regression):
    base = fitted(regression, Model())
    found = extended_arm(regression, base, estimates(regression, base))
    for name, true in (("D1", 0.3), ("fc1", 0.05)):
        estimate = found.base_parameters[name]
        assert abs(estimate.value - true) < 4.0 * estimate.std < 0.2 * true


def test_errors_are_as_large_as_they_are_said_to_be_and_what_is_left_is_noise():
    """Noise is white in the band that is looked at, not from sample to sample: neighbours are no new equations."""
    off, left = [], []
    for seed in range(16):
        trials = to_trials(swings((), trials=6, seed=seed), cutoff_hz=25.0)
        one = regression_of(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))
        base = fitted(one, Model())
        found = extended_arm(one, base, estimates(one, base)).base_parameters
        off.append([(found[name].value - true) / found[name].std for name, true in (("D1", 0.3), ("fc1", 0.05))])
        n_effective = [one.weighting.n_effective(motion) for motion in one.motions[3:]]
        left.append(base.squares[3:].sum() / sum(n_effective))
    assert 0.9 < np.mean(left) < 1.15
    # Sixteen draws are off by 0.6 to 1.45 times their error in the mean square, but for once in a hundred times.
    assert np.all(np.abs(np.sqrt(np.mean(np.square(off), axis=0)) - 1.0) < 0.45)


def test_friction_that_would_push_is_none_in_a_simulation(regression):
    base = fitted(regression, Model())
    x = base.x.copy()
    x[-1] = -0.02
    found = estimates(regression, replace(base, x=x))
    arm = extended_arm(regression, replace(base, x=x), found)
    assert arm.joints[0].friction.coulomb_N_m == 0.0
    assert arm.base_parameters["fc1"].value == pytest.approx(-0.02)
    assert arm.joints[0].friction.viscous_N_m_s == pytest.approx(0.3, abs=0.02)
    assert np.isfinite(found.std).all()


def test_a_size_differs_from_none_by_its_error(regression):
    """Wald's test at 95 %: 1.96 standard errors of one number."""
    drag = JointHypothesis(catalogue()["quadratic_drag"], 0)
    base = fitted(regression, Model())
    for sigmas, said in ((1.9, False), (2.0, True)):
        dragged = replace(base, model=Model((drag,), (np.zeros(0),)), x=np.append(base.x, 0.1))
        covariance = np.diag(np.append(np.ones(len(base.x)), (0.1 / sigmas) ** 2))
        assert significant(dragged, covariance) == [said]


@pytest.mark.parametrize(("stiffness_std", "said"), [(0.03, True), (0.06, False)])
def test_a_spring_without_stiffness_is_no_spring(regression, stiffness_std, said):
    """Its stiffness is the columns' sum, 0.1: of two columns 2.45 standard errors are asked for."""
    spring = JointHypothesis(catalogue()["joint_spring"], 0)
    base = fitted(regression, Model())
    sprung = replace(base, model=Model((spring,), (np.zeros(0),)), x=np.append(base.x, [0.05, 0.05]))
    covariance = np.diag(np.append(np.ones(len(base.x)), [stiffness_std**2, 1e-6]))
    assert significant(sprung, covariance) == [said]
