"""What is taken to be a rest and what is not, window by window and along a recording."""

import numpy as np
import pytest

from arm.accelerometer import specific_force
from tracking.model.course import course_of
from tracking.model.expected_readings import room_of
from tracking.model.first_rest import resting
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.noise import Noise
from tracking.model.observation import observation_of
from tracking.model.readings import Readings
from tracking.model.zero_velocity import (
    CELL_S,
    WINDOW_S,
    at_rest,
    rest_variance,
    unrest,
    unsteadiness,
    window_frames,
    window_of,
)
from tracking.smoother.smoother import Smoother

SIGMA = 0.02
#: Samples of a cell, at 4 kHz.
CELL = 40
POSE = np.array([0.4, -0.3])


def filled(arm, readings, sigma=SIGMA, rounding=0.0):
    """Return a window whose cells are given."""
    variance = np.full(3 * len(arm.sensors), sigma**2 / CELL)
    size = observation_of(arm)[1]
    window = window_of(round(WINDOW_S / CELL_S), size, variance, np.full_like(variance, rounding))
    window.cells[:] = readings
    return window


def cruising(arm, speed, rng, sigma=SIGMA):
    """Return cells of a quarter of a second at constant speed, noise and all."""
    t = CELL_S * np.arange(round(WINDOW_S / CELL_S))[:, None]
    q, dq = POSE + speed * (t - t.mean()), np.full((len(t), 2), speed)
    felt = specific_force(arm, q, dq, np.zeros_like(q)).reshape(len(t), -1)
    return felt + sigma / np.sqrt(CELL) * rng.standard_normal(felt.shape)


def judged(arm, window, offset_std, speed_std=0.01, speed=0.0):
    """Return the window's unrest and the hidden variance, for an estimate that knows the pose to 1e-3 rad."""
    of, size = observation_of(arm)
    x, std, hidden = np.zeros(size), np.full(size, 1e-3), np.empty(2)
    x[[0, 3]], x[[1, 4]] = POSE, speed
    std[6:18], std[[1, 4]] = offset_std, speed_std
    return unrest(of, room_of(2), window, 0, x, np.diag(std**2), hidden), hidden


@pytest.mark.parametrize("seed", range(20))
def test_an_arm_at_rest_is_recognised(dd_arm, vertical_arm, seed):
    for arm in (dd_arm, vertical_arm):
        cells = cruising(arm, 0.0, np.random.default_rng(seed))
        assert judged(arm, filled(arm, cells), 0.02)[0] < 1.0


@pytest.mark.parametrize("seed", range(20))
def test_a_cruise_whose_centripetal_acceleration_shows_is_none(dd_arm, seed):
    """Constant speed: readings stay what they are, but are not those of an arm at rest."""
    window = filled(dd_arm, cruising(dd_arm, 0.3, np.random.default_rng(seed)))
    assert unsteadiness(window, 0) < 1.0
    assert judged(dd_arm, window, 0.002)[0] > 1.0


def test_a_cruise_that_offsets_could_explain_is_known_by_its_speed(dd_arm):
    """Offsets known to 0.2 m/s^2 hide what the sensors feel; but the filter knows that it moves."""
    window = filled(dd_arm, cruising(dd_arm, 0.3, np.random.default_rng(0)))
    assert judged(dd_arm, window, 0.2)[0] < 1.0
    assert judged(dd_arm, window, 0.2, speed=0.3)[0] > 1.0


def test_a_motion_that_turns_gravity_is_none(vertical_arm):
    """Slower than any centripetal acceleration shows: 0.05 rad/s tilt the sensors by a hundredth in a window."""
    window = filled(vertical_arm, cruising(vertical_arm, 0.05, np.random.default_rng(0)))
    assert unsteadiness(window, 0) > 1.0


def test_a_knock_is_no_rest(dd_arm):
    cells = cruising(dd_arm, 0.0, np.random.default_rng(1))
    cells[7, 4] += 8 * SIGMA / np.sqrt(CELL)
    assert judged(dd_arm, filled(dd_arm, cells), 0.2)[0] > 1.0


@pytest.mark.parametrize("oldest", [0, 3, 17])
def test_a_window_is_a_ring(dd_arm, oldest):
    """Which row is the oldest makes no difference but to which half is which."""
    cells = cruising(dd_arm, 0.0, np.random.default_rng(2)) + np.linspace(0.0, 0.02, 25)[:, None]
    expected = unsteadiness(filled(dd_arm, cells), 0)
    assert unsteadiness(filled(dd_arm, np.roll(cells, oldest, axis=0)), oldest) == pytest.approx(expected)


def test_what_rounding_hides_is_no_motion(dd_arm):
    """Readings that hang between two steps may read either, for as long as they like."""
    cells = cruising(dd_arm, 0.0, np.random.default_rng(3), sigma=0.0)
    cells[:13, 0] += 0.0015
    assert unsteadiness(filled(dd_arm, cells, sigma=1e-4), 0) > 1.0
    assert unsteadiness(filled(dd_arm, cells, sigma=1e-4, rounding=0.0015**2 / 12), 0) < 1.0


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_the_speed_that_could_hide_grows_with_the_noise(dd_arm, factor):
    cells = cruising(dd_arm, 0.0, np.random.default_rng(0), sigma=0.0)
    _, hidden = judged(dd_arm, filled(dd_arm, cells), 0.02)
    _, other = judged(dd_arm, filled(dd_arm, cells, factor * SIGMA), 0.02)
    np.testing.assert_allclose(other, factor**2 * hidden, rtol=1e-4)
    assert (np.sqrt(hidden) < 0.1).all()
    np.testing.assert_allclose(rest_variance(hidden, 1e-3), 1000.0 * hidden)


def test_an_elbow_hides_more_than_a_shoulder_shows(dd_arm):
    """The more sensors feel a joint and the further out they are, the less of its speed can hide."""
    cells = cruising(dd_arm, 0.0, np.random.default_rng(0))
    _, hidden = judged(dd_arm, filled(dd_arm, cells), 0.02)
    assert hidden[0] < hidden[1]


def test_a_state_at_rest_keeps_all_but_its_motion():
    x = np.arange(1.0, 11.0)
    np.testing.assert_array_equal(at_rest(x, 2), [1, 0, 0, 4, 0, 0, 7, 8, 9, 10])
    assert x[1] == 2.0


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_does_not_break_a_rest(dd_arm, seed):
    """Ten seconds: some thousand windows of twelve channels, none of which is taken for a motion."""
    rng = np.random.default_rng(seed)
    still = np.zeros((1, 2))
    level = specific_force(dd_arm, POSE[None], still, still).ravel() + 0.02 * rng.normal(size=12)
    values = level + SIGMA / 2.0 * rng.standard_normal((10_000, 12))
    readings = Readings(values, 1e-3, 5e-4, Noise(np.full(12, SIGMA**2), np.zeros(12)), 4)
    smoother = Smoother(dd_arm, POSE, True)
    of, size, first = smoother.observation, smoother.size, readings.first_mean
    x, P = start_state(dd_arm, of, size, resting(first), POSE, True, MountingPrior())
    states, still, at_rest = smoother._filter(course_of(readings, 2), readings, x, P)
    assert at_rest.all() and still.mean() > 0.99
    assert np.abs(states[:, [1, 4]]).max() < 0.02


@pytest.mark.parametrize(
    ("dt_s", "frames"), [(0.25 * CELL_S, 4), (0.5 * CELL_S, 2), (CELL_S, 1), (1.4 * CELL_S, 1), (3.0 * CELL_S, 1)]
)
def test_a_cell_has_one_frame_at_least_and_a_window_lasts_as_long(dt_s, frames):
    cell, window = window_frames(dt_s)
    assert cell == frames
    assert window == max(4, round(WINDOW_S / (frames * dt_s)))
