"""When a motor surely touches a side of its gap, and how its link moves there."""

import numpy as np
import pytest

from fitter.diagnosis.contacts import FEW, Motor, Run, contact_runs, contact_side
from fitter.diagnosis.free_link import FreeLink

DT, NOISE = 0.002, 0.01
N = 1000


def noise(seed: int = 0, n: int = N) -> np.ndarray:
    return NOISE * np.random.default_rng(seed).normal(size=n)


def test_noise_about_zero_touches_nothing():
    assert not contact_runs(noise(n=2000), NOISE, DT)


def test_a_weak_but_steady_torque_is_a_contact():
    """A tenth of a second of one standard deviation: ten standard errors of its mean."""
    torque = np.where((np.arange(N) > 300) & (np.arange(N) < 700), NOISE, 0.0) + noise()
    (run,) = contact_runs(torque, NOISE, DT)
    assert run.side == 1.0
    assert 300 < run.first < 500 < run.last < 700


@pytest.mark.parametrize("torque_n_m", [0.1, 10.0, 1e4])
def test_no_contact_is_said_beyond_its_end(torque_n_m):
    inside = (np.arange(N) >= 400) & (np.arange(N) < 600)
    side = contact_side(np.where(inside, -torque_n_m, 0.0) + noise(1), NOISE, DT)
    assert np.all(side[~inside] == 0.0)
    assert np.all(side[410:590] == -1.0)


def swinging(link_inertia: float = 0.2, lacking: float = 0.0) -> tuple[np.ndarray, np.ndarray, FreeLink]:
    """Return the angle and torque of a link that a motor swings, and what moves it."""
    t = np.arange(N) * DT
    angle = np.sin(5.0 * t)
    torque = -25.0 * link_inertia * angle + 0.3
    return angle, torque, FreeLink(t, np.full(N, link_inertia), np.full(N, 0.3), 0.0, 0.0, lacking)


def test_angle_and_slope_at_an_end_are_off_by_their_covariance():
    """A hundred noises: their scatter is what the covariance says, less than one angle's."""
    angle, torque, link = swinging()
    run, shaking, off = Run(300, 500, 1.0), 1e-3, []
    for seed in range(100):
        noisy = angle + shaking * np.random.default_rng(seed).normal(size=N)
        knot = Motor(noisy, torque, (shaking, NOISE), [], link, DT).departure(run)
        off.append((knot.angle - angle[500], knot.slope - 5.0 * DT * np.cos(5.0 * 500 * DT)))
    scatter = np.mean(np.square(off), axis=0) / shaking**2
    np.testing.assert_allclose(scatter, np.diag(knot.covariance), rtol=0.5)
    assert scatter[0] < 0.2


def test_of_a_link_that_moves_otherwise_fewer_angles_are_believed():
    angle, torque, link = swinging()
    angle = angle + np.where(np.arange(N) > 480, 0.5 * ((np.arange(N) - 480) * DT) ** 2 * 50.0, 0.0)
    shaking = 1e-4
    noisy = angle + shaking * np.random.default_rng(3).normal(size=N)
    knot = Motor(noisy, torque, (shaking, NOISE), [], link, DT).departure(Run(300, 500, 1.0))
    assert abs(knot.angle - angle[500]) < 4.0 * shaking
    assert knot.covariance[0, 0] > 1.0 / (200 - 1)


def test_a_contact_shorter_than_a_few_samples_has_an_end():
    angle, torque, link = swinging()
    knot = Motor(angle, torque, (1e-6, NOISE), [], link, DT).arrival(Run(400, 401, -1.0))
    assert knot.at == 400
    assert knot.angle == pytest.approx(angle[400], abs=1e-5)
    assert FEW > 1
