"""How much is left of readings, and on what it depends, by residuals that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from fitter.reading_diagnosis.sensor_residual import contradiction, dependence_of_residual, noise_factor

N_CHANNEL, N_JOINT, N = 12, 2, 800


def along(number, wrong=lambda _q: 0.0, noise=1.0):
    """Return a trial whose residual is white noise, and something more."""
    rng, t = np.random.default_rng(number), np.arange(N) * 0.01
    q = np.sin(np.outer(t, [2.0, 3.3]) + rng.uniform(0.0, 6.0, 2))
    residual = noise * rng.normal(size=(N, N_CHANNEL))
    residual[:, 4] += wrong(q)
    return SimpleNamespace(
        trial=SimpleNamespace(t=t, dt_s=0.01),
        q=q,
        dq=np.gradient(q, 0.01, axis=0),
        residual=residual,
        weight=np.ones((N, N_CHANNEL)),
        correlation=np.zeros(N_CHANNEL),
    )


def test_noise_that_neighbours_share_is_measured_as_well():
    trials, fitted = judged()
    for k in range(6):
        one = trials.explained(k, None, None)
        shared = (one.residual[1:, :3] + one.residual[:-1, :3]) / np.sqrt(2.0)  # correlated by a half
        one.residual[1:, :3], one.correlation[:3] = shared, 0.5
    assert noise_factor(trials, fitted) * 10.0 / 12.0 == pytest.approx(1.0, abs=0.03)


def judged(noise=1.0):
    """Return trials of which three judge, and a fit that leaves what no motion takes: 10 of 12 numbers a frame."""
    some = [along(k, noise=noise) for k in range(6)]
    trials = SimpleNamespace(
        n_learn=3,
        arm=SimpleNamespace(n_joint=N_JOINT),
        trials=[SimpleNamespace(values=one.residual) for one in some],
        explained=lambda number, _hypothesis, _motion: some[number],
        dropped=lambda *_: 0,
    )
    squares = np.array([np.sum(one.residual[:, :10] ** 2) for one in some])
    return trials, SimpleNamespace(
        hypothesis=SimpleNamespace(free_base=False), motions=[None] * 6, squares=squares
    )


def test_a_function_of_an_angle_is_what_it_depends_on():
    found = dependence_of_residual(
        [along(k, lambda q: 2.0 * q[:, 1] ** 2) for k in range(4)], False, np.random.default_rng(0)
    )
    assert found.depends_on[0] == "q2"
    power = np.var(2.0 * np.sin(np.linspace(0.0, 200.0, 20_000)) ** 2)
    mean = 1.0  # a constant is explained as well
    assert found.explained == pytest.approx((power + mean) / (power + mean + N_CHANNEL), abs=0.03)


def test_noise_is_not_asked_and_depends_on_nothing():
    assert dependence_of_residual([along(k) for k in range(4)], True, np.random.default_rng(0)).depends_on == ()
    assert dependence_of_residual([along(k) for k in range(4)], False, np.random.default_rng(0)).explained < 0.02


@pytest.mark.parametrize("noise", [1.0, 1.3])
def test_noise_is_measured_from_frame_to_frame(noise):
    trials, fitted = judged(noise)
    factor = noise_factor(trials, fitted) * 10.0 / 12.0  # here all 12 channels have it, for no motion was taken
    assert factor == pytest.approx(noise**2, rel=0.05)


def test_mere_noise_is_no_contradiction_and_a_hundredth_more_of_it_is_told_in_its_sigmas():
    trials, fitted = judged()
    free = 3 * N * (N_CHANNEL - N_JOINT)
    found = contradiction(trials, fitted, 1.0)
    assert abs(found.sigmas) < 3.0
    assert found.excess == pytest.approx(fitted.squares[3:].sum() / free - 1.0)
    assert found.beyond == pytest.approx(found.excess * free)
    assert found.sigmas == pytest.approx(found.beyond / np.sqrt(6.0 * free))
