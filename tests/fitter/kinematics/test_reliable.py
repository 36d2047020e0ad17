"""Corrected sums, where they are more than chance."""

import numpy as np

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.kinematics.reliable import reliable
from fitter.kinematics.tip_basis import coefficients, geometry_of, turning
from fitter.kinematics.tip_sums import tip_sums

ARM = load_arm("dd-arm")


def both(q, tip, noise):
    plain, corrected = (tip_sums(ARM, q, tip, angle_noise=std).total() for std in (None, noise))
    cost = reliable(
        plain.whitened(), corrected.gram[0], corrected.moment[0], corrected.power[0], corrected.samples
    )
    return plain.whitened(), cost


def test_without_noise_it_is_the_same_cost():
    rng = np.random.default_rng(0)
    q, tip = rng.normal(size=(300, 2)), rng.normal(size=(300, 3))
    sums = tip_sums(ARM, q, tip).total()
    plain = sums.whitened()
    cost = reliable(plain, sums.gram[0], sums.moment[0], sums.power[0], sums.samples)
    for _ in range(3):
        C = rng.normal(size=(3, 8))
        expected = np.sum((plain.W @ C.T - plain.z) ** 2) + plain.rest.sum()
        assert np.isclose(np.sum((cost.W @ C.T - cost.z) ** 2) + cost.rest.sum(), expected, rtol=1e-9)


def test_what_only_noise_moves_is_left_out():
    rng = np.random.default_rng(1)
    q = np.column_stack([rng.uniform(-1.0, 1.0, 4000), np.full(4000, 0.4)])
    tip, noise = tip_position(ARM, q), np.full(2, 0.1)
    plain, cost = both(q + noise * rng.normal(size=q.shape), tip, noise)
    assert len(plain.W) == 8
    assert 2 <= len(cost.W) <= 3  # the circle of joint 1, and nothing of joint 2
    C = coefficients(turning(ARM), geometry_of(ARM)[None])[0, :, 1:]
    left = np.sum((cost.W @ C.T - cost.z) ** 2) / 4000
    assert left < 1e-4
