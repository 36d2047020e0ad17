"""The equations' weights: how large noise is, and what holds a joint is not seen."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.error_floor import first_weighting
from fitter.diagnosis.whitening import holding_shapes
from tests.fitter.diagnosis.searched import swinging
from tests.fitter.diagnosis.two_joints import regression_of_two


@pytest.fixture(scope="module")
def regression():
    return swinging(trials=4)


def test_noise_is_as_large_as_it_was_made():
    """0.01 N m and 2e-4 rad, by its third differences; their power per band is kept on a thinned grid."""
    run = regression_of_two(trials=4)
    found = first_weighting(run.arm, run.motions)
    thinned = np.sqrt(run.motions[0].trial.dt_s / run.motions[0].dt_s)
    np.testing.assert_allclose(found.torque_noise, 0.01 * thinned, rtol=0.1)
    np.testing.assert_allclose(np.sqrt(np.diag(found.acceleration_noise)), 2e-4 * thinned, rtol=0.1)
    assert not found.holding  # nothing tells yet


def test_a_torque_of_any_size_that_holds_a_joint_leaves_nothing(regression):
    unknown = first_weighting(regression.arm, regression.motions)
    motion = next(one for one in regression.motions if np.any(one.stuck))
    shapes = holding_shapes(motion.stuck[:, 0], motion.dt_s)
    seen, left = unknown.whitened_at(motion, 0, shapes), unknown.filtered_at(motion, 0, shapes)
    assert np.linalg.norm(left) < 1e-4 * np.linalg.norm(seen)


def test_axes_are_orthonormal_and_lose_no_more_than_all(regression):
    axes, lost = regression.weighting.axes(regression.motions[0])
    np.testing.assert_allclose(axes.T @ axes, np.eye(len(lost)), atol=1e-6)
    assert np.all((lost >= 0.0) & (lost <= 1.0))


def test_what_is_eliminated_is_not_told(regression):
    filt, motion = regression.weighting, regression.motions[0]
    rows = len(filt.whitened(motion, np.zeros((*motion.q.shape, 1))))
    assert 0.0 < filt.n_effective(motion) < filt.n_in_band(rows, motion.dt_s)
    lost = filt.axes(motion)[1]
    assert filt.n_in_band(rows, motion.dt_s) - filt.n_effective(motion) <= len(lost)


def of_trial(regression, **known):
    """Return a motion whose trial and itself are known to be otherwise, under a number of its own."""
    motion = regression.motions[0]
    trial = replace(motion.trial, **{name: known[name] for name in ("target_std",) if name in known})
    marked = {name: known[name] for name in ("contradicted",) if name in known}
    return replace(motion, trial=trial, number=99, **marked)


def test_a_constant_torque_counts_as_far_as_a_found_target_is_known(regression):
    weighting = first_weighting(regression.arm, regression.motions)
    motion = regression.motions[0]
    one = np.ones((len(motion.t), 1))
    seen = np.linalg.norm(weighting.filtered_at(motion, 0, one))
    for number, std in enumerate((1e-9, 1.0, 1e3), 100):
        motion = replace(of_trial(regression, target_std=np.array([std])), number=number)
        found = np.linalg.norm(weighting.filtered_at(motion, 0, one))
        assert found == pytest.approx(
            seen / np.hypot(1.0, std * seen), rel=1e-3
        )  # by its variance and white noise's


def test_torques_that_the_data_contradicts_are_not_seen(regression):
    weighting = first_weighting(regression.arm, regression.motions)
    contradicted = np.zeros_like(regression.motions[0].stuck)
    contradicted[40:80] = True
    motion = of_trial(regression, contradicted=contradicted)
    shapes = holding_shapes(contradicted[:, 0], motion.dt_s)
    seen, left = weighting.whitened_at(motion, 0, shapes), weighting.filtered_at(motion, 0, shapes)
    assert np.linalg.norm(left) < 1e-4 * np.linalg.norm(seen)
