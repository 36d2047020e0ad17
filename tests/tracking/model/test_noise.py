"""The noise of readings, found in the readings alone."""

import numpy as np
import pytest

from tracking.model.noise import Noise, StepWatch, noise_of

STEP = 0.0015
RATE_HZ = 4000.0


def readings(sigma, seconds=5.0, motion=0.0, step=0.0, seed=0, n_channel=4):
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * RATE_HZ))[:, None] / RATE_HZ
    phase = rng.uniform(0.0, 6.0, (3, n_channel))
    swing = sum(np.sin(2 * np.pi * f * t + p) for f, p in zip((0.7, 2.0, 5.0), phase, strict=True))
    found = rng.uniform(-9.8, 9.8, n_channel) + motion * swing + sigma * rng.standard_normal((len(t), n_channel))
    return np.rint(found / step) * step if step else found


@pytest.mark.parametrize("motion", [0.0, 3.0])
@pytest.mark.parametrize("sigma", [0.002, 0.02, 0.1])
@pytest.mark.parametrize("seed", range(3))
def test_white_noise_is_found_within_a_tenth(sigma, motion, seed):
    """Whether the arm rests or swings."""
    found = np.sqrt(noise_of(readings(sigma, motion=motion, seed=seed), RATE_HZ).variance)
    np.testing.assert_allclose(found, sigma, rtol=0.1)


def test_the_first_quarter_of_a_second_is_enough():
    """As the live filter has it; of so few cells the calmest are luck, so a fifth more or less is fine."""
    found = np.sqrt([noise_of(readings(0.02, seconds=0.25, seed=seed), RATE_HZ).variance for seed in range(10)])
    np.testing.assert_allclose(found, 0.02, rtol=0.25)
    assert found.mean() == pytest.approx(0.02, rel=0.1)


def test_each_channel_has_its_own():
    quiet = readings(0.01, n_channel=3)
    quiet[:, 1] += 0.05 * np.random.default_rng(9).standard_normal(len(quiet))
    found = np.sqrt(noise_of(quiet, RATE_HZ).variance)
    np.testing.assert_allclose(found, [0.01, np.hypot(0.01, 0.05), 0.01], rtol=0.1)


def test_dithered_rounding_hides_nothing():
    """From half a step of noise on a mean knows no steps; the rounding then is noise like any other."""
    found = noise_of(readings(STEP, step=STEP), RATE_HZ)
    np.testing.assert_allclose(np.sqrt(found.variance), np.sqrt(STEP**2 * 13 / 12), rtol=0.1)
    assert found.rounding.max() < 1e-6 * STEP**2


def test_undithered_rounding_is_not_averaged_away():
    """Noise of a fiftieth of a step, on a slow swing that takes it over the steps."""
    found = noise_of(readings(STEP / 50, motion=0.01, step=STEP), RATE_HZ)
    assert (found.rounding > 0.1 * STEP**2 / 12).all()
    assert (found.rounding <= STEP**2 / 12 * (1 + 1e-9)).all()
    assert (found.of_mean(10**9) > 0.1 * STEP**2 / 12).all()


def test_quiet_readings_are_not_trusted_without_end():
    """That never leave their step: nothing can be told of it, but nobody's accelerometer is perfect."""
    found = noise_of(np.full((1000, 3), 9.8), RATE_HZ)
    np.testing.assert_array_equal(found.variance, 0.0)
    np.testing.assert_allclose(found.of_mean(32), 1e-8 * RATE_HZ / 32)  # ten microgees per root Hz


def test_a_mean_has_its_share_of_the_white_noise_and_all_of_the_rounding():
    noise = Noise(np.array([4e-4, 4e-4]), np.array([0.0, 1e-6]))
    np.testing.assert_allclose(noise.of_mean(1), [4e-4, 4.01e-4])
    np.testing.assert_allclose(noise.of_mean(400), [1e-6, 2e-6])


@pytest.mark.parametrize("n", [4, 5, 8, 63, 64, 65, 1000])
def test_any_number_of_readings_will_do(n):
    found = noise_of(readings(0.02)[:n], RATE_HZ)
    assert np.isfinite(found.variance).all() and (found.variance > 0.0).all()
    assert found.variance.shape == found.rounding.shape == (4,)


def test_the_parts_of_a_mean_s_noise_add_up():
    noise = Noise(np.array([4e-4, 1e-9]), np.array([0.0, 1e-6]), 4e-6)
    white, rounding = noise.parts_of_mean(4)
    np.testing.assert_allclose(white, [1e-4, 1e-6])  # nobody's accelerometer is perfect
    np.testing.assert_array_equal(rounding, noise.rounding)
    np.testing.assert_allclose(white + rounding, noise.of_mean(4))


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3])
def test_what_rounding_hides_goes_by_the_noise_against_the_step(share):
    """By Widrow and Kollar: a twelfth of a squared step, less the more noise there is."""
    found = noise_of(readings(share * STEP, motion=0.01, step=STEP), RATE_HZ)
    expected = STEP**2 / 12.0 * np.exp(-4.0 * np.pi**2 * found.variance / STEP**2)
    np.testing.assert_allclose(found.rounding, expected, rtol=1e-6)


def test_a_channel_that_never_changes_is_converted_like_the_others():
    some = readings(STEP / 50, motion=0.01, step=STEP)
    some[:, 2] = 0.3
    found = noise_of(some, RATE_HZ)
    assert found.rounding[2] == pytest.approx(STEP**2 / 12.0)


def test_a_converter_s_step_is_learnt_when_something_moves():
    """From one call to the next, too: the last reading of one is held against the first of the other."""
    watch = StepWatch(Noise(np.zeros(2), np.zeros(2)))
    still = np.zeros((10, 2))
    assert not watch.look(still) and not watch.look(still[:0])
    assert watch.look(still + STEP)
    np.testing.assert_allclose(watch.noise.rounding, STEP**2 / 12.0)
    assert not watch.look(still + 3.0 * STEP)  # a step of two
    assert not watch.look(still + 3.0 * STEP)
    assert watch.look(np.vstack([still, still + 0.5 * STEP]))
    np.testing.assert_allclose(watch.noise.rounding, (0.5 * STEP) ** 2 / 12.0)


def test_readings_that_show_no_smaller_step_are_taken_in():
    watch, still = StepWatch(Noise(np.zeros(2), np.zeros(2))), np.zeros((10, 2))
    assert watch.takes_quietly(still) and watch.takes_quietly(still[:0])
    assert not watch.takes_quietly(still + STEP)
    assert watch.look(still + STEP)  # which were left to it
    assert watch.takes_quietly(still + 3.0 * STEP)
    assert not watch.takes_quietly(still + 2.5 * STEP)  # from the last that was taken in
    assert watch.takes_quietly(still + 2.0 * STEP)


def bumps(sizes, cell):
    """Return a channel that stands still but for one reading in the middle of each cell, so much higher."""
    found = np.zeros((cell * len(sizes), 1))
    found[cell // 2 :: cell, 0] = sizes
    return found  # the third differences of one of size a are a, -3a, 3a, -a: 20 a^2 in all


@pytest.mark.parametrize(
    ("sizes", "cell", "n", "expected"),
    [
        ([1.0], 8, 8, 1.0 / 5.0),  # of eight readings five third differences
        ([2.0], 63, 63, 4.0 / 60.0),
        ([3.0, 1.0, 2.0, 4.0], 16, 64, 1.0 / 13.0 / (1.0 - 1.27 * np.sqrt(4.6 / 13.0))),
        ([3.0, 1.0, 2.0, 4.0], 64, 256, 1.0 / 61.0 / (1.0 - 1.27 * np.sqrt(4.6 / 61.0))),
        # the calmest quarter of ten are two
        ([5.0, 9.0, 1.0, 7.0, 8.0, 2.0, 6.0, 4.0, 10.0, 3.0], 64, 640, 2.5 / 61.0 / 0.651246),
        ([3.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0], 64, 448, 1.0 / 61.0 / 0.651246),
    ],
)
def test_the_calmest_quarter_of_cells_counts(sizes, cell, n, expected):
    found = bumps(sizes, cell)
    assert len(found) == n
    assert noise_of(found, RATE_HZ).variance == pytest.approx(expected, rel=1e-5)


def test_a_step_that_hardly_changes_what_is_hidden_changes_nothing():
    watch = StepWatch(Noise(np.zeros(1), np.full(1, 0.95 / 12.0)))
    assert not watch.look(np.array([[0.0], [1.0]]))  # within a tenth
    assert watch.noise.rounding[0] == 0.95 / 12.0
    watch = StepWatch(Noise(np.zeros(1), np.full(1, 0.85 / 12.0)))
    assert watch.look(np.array([[0.0], [1.0]]))
    assert watch.noise.rounding[0] == pytest.approx(1.0 / 12.0)
