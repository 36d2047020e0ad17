"""Moments that are zero at the true geometry and noise."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from arm.model import Arm, Joint
from fitter.kinematics.tip_basis import coefficients, geometry_of, turning
from fitter.kinematics.tip_moments import PAIRS, TipMoments, joined

SPATIAL = Arm(
    "spatial", (Joint(a_m=0.2), Joint("prismatic", alpha_rad=1.2, a_m=0.1, d_m=0.2), Joint(alpha_rad=0.7))
)
ARMS = [load_arm("dd-arm"), SPATIAL.with_joints(a_m=np.array([0.2, 0.1, 0.3]))]


def noisy(arm, q, std, tip_std):
    """Return measurements of one configuration; angles and tip."""
    rng = np.random.default_rng(0)
    n = 4000
    errors = std * rng.normal(size=(n, arm.n_joint)), rng.normal(size=(n, 3)) @ np.linalg.cholesky(tip_std).T
    return q + errors[0], tip_position(arm, q[None]) + errors[1]


@pytest.mark.parametrize("arm", ARMS)
def test_they_vanish_on_average_wherever_the_arm_stands(arm):
    rng = np.random.default_rng(1)
    std, R = rng.uniform(0.05, 0.2, arm.n_joint), np.diag([1e-4, 4e-4, 9e-4]) + 1e-5
    C = coefficients(turning(arm), geometry_of(arm)[None])[0]
    moments = TipMoments(turning(arm), 2)
    covariance = np.array([R[x, y] for x, y in PAIRS])
    for q in rng.uniform(-1.0, 1.0, (2, arm.n_joint)):
        values = moments.samples(*noisy(arm, q, std, R), C, std**2, covariance)
        scatter = values.std(axis=0) / np.sqrt(len(values)) + 1e-12
        assert values.shape[1] == moments.size
        assert np.max(np.abs(values.mean(axis=0)) / scatter) < 5.0
        wrong = moments.samples(*noisy(arm, q, std, R), C, 0.5 * std**2, covariance)
        assert np.max(np.abs(wrong.mean(axis=0)) / (wrong.std(axis=0) / np.sqrt(len(values)) + 1e-12)) > 6.0


def test_sums_hold_what_the_samples_do():
    arm, rng = ARMS[1], np.random.default_rng(2)
    q, tip = rng.normal(size=(501, 3)), rng.normal(size=(501, 3))
    moments, C = TipMoments(turning(arm), 2), rng.normal(size=(3, 18))
    one_by_one = moments.samples(q, tip, C, np.full(3, 0.01), np.zeros(6))
    parts = joined([moments.sums(q[:200], tip[:200], 0, 3), moments.sums(q[200:], tip[200:], 1, 4)])
    assert parts.trial.tolist() == [0] * 3 + [1] * 4
    whole = moments.values(parts.whole(), C, np.full(3, 0.01), np.zeros(6))[0]
    assert np.allclose(whole, one_by_one.mean(axis=0), atol=1e-12)
    origin = np.array([[0.1, -0.2, 0.3], [1.0, 2.0, 3.0]])
    elsewhere = joined(
        [moments.sums(q[:200], tip[:200] + origin[0], 0, 3), moments.sums(q[200:], tip[200:] + origin[1], 1, 4)]
    )
    assert np.allclose(moments.moved(parts, origin).tip, elsewhere.tip, atol=1e-12)
