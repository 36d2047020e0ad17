"""What is held of the state before the first reading."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.model import Arm, Joint, Sensor, SensorCovariance
from tracking.model.first_rest import FirstReadings, resting
from tracking.model.initial_state import GIVEN_STD, GUESSED_STD, MountingPrior, start_state
from tracking.model.observation import MOUNTING, observation_of

Q = np.array([0.4, -0.3])
STILL = np.zeros((1, 2))


@pytest.fixture(scope="module")
def vertical():
    return load_arm("dd-arm-vertical")


def at_rest(arm, q):
    felt = specific_force(arm, q[None], STILL, STILL)[0]
    return (felt * np.array([sensor.scale for sensor in arm.sensors])).ravel()


def started(arm, first, q=None, mounting=None, steady=True):
    of, size = observation_of(arm, mounting is not None)
    at = np.zeros(arm.n_joint) if q is None else q
    return of, *start_state(
        arm,
        of,
        size,
        FirstReadings(first, np.full(len(first), 0.0 if steady else np.inf)),
        at,
        q is not None,
        mounting or MountingPrior(),
    )


def test_gravity_shows_the_angles_of_an_upright_arm(vertical):
    _, x, P = started(vertical, at_rest(vertical, Q))
    np.testing.assert_allclose(x[:6:3], Q, rtol=0, atol=1e-3)
    np.testing.assert_allclose(np.sqrt(np.diag(P)[:6:3]), GUESSED_STD, rtol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_offsets_show_as_angles_no_larger_than_they_are(vertical, seed):
    """0.02 m/s^2 are a fifth of a hundredth of gravity."""
    offset = 0.02 * np.random.default_rng(seed).normal(size=12)
    _, x, _ = started(vertical, at_rest(vertical, Q) + offset)
    assert np.abs(x[:6:3] - Q).max() < 4 * np.sqrt(2) * 0.02 / 9.8


def test_angles_that_gravity_does_not_show_are_the_zero(dd_arm):
    """Whatever the offsets: of a level arm all angles are what everything is counted from."""
    first = at_rest(dd_arm, Q) + 0.1 * np.random.default_rng(0).normal(size=12)
    _, x, P = started(dd_arm, first)
    np.testing.assert_allclose(x[:6:3], 0.0, rtol=0, atol=1e-12)
    assert np.sqrt(np.diag(P)[:6:3]).max() <= 1e-4


def test_given_angles_that_gravity_does_not_show_are_exact(dd_arm):
    _, x, P = started(dd_arm, at_rest(dd_arm, Q), Q)
    np.testing.assert_array_equal(x[:6:3], Q)
    assert np.sqrt(np.diag(P)[:6:3]).max() <= 1e-4


def test_given_angles_that_gravity_shows_are_trusted_to_a_hundredth(vertical):
    """Each of them and their differences too: whoever measured may have been off by that."""
    _, x, P = started(vertical, at_rest(vertical, Q), Q)
    np.testing.assert_array_equal(x[:6:3], Q)
    np.testing.assert_allclose(P[:6:3, :6:3], GIVEN_STD**2 * np.eye(2), rtol=0.01, atol=1e-8)


def test_offsets_out_of_the_file_are_believed(dd_arm):
    known = replace(dd_arm, sensors=tuple(replace(s, bias_m_s2=(0.1, -0.2, 0.3)) for s in dd_arm.sensors))
    _, x, _ = started(known, at_rest(known, Q))
    np.testing.assert_allclose(x[6:18], np.tile([0.1, -0.2, 0.3], 4))


@pytest.mark.parametrize("size", [0.0, 0.02, 0.1, 1.0])
def test_first_readings_show_how_large_offsets_are(dd_arm, size):
    """Of sensors that are alike: none is held to be less than a few times what they show together, or endless."""
    offset = size * np.random.default_rng(2).normal(size=12)
    std = np.sqrt(np.diag(started(dd_arm, at_rest(dd_arm, Q) + offset, Q)[2])[6:18])
    np.testing.assert_array_equal(std, std[0])
    assert min(size, 0.1) < std[0] < 4 * max(size, 0.02)


def test_speeds_begin_at_zero(vertical):
    _, x, P = started(vertical, at_rest(vertical, Q), Q)
    np.testing.assert_array_equal(x[[1, 2, 4, 5]], 0.0)
    assert (np.diag(P)[[1, 2, 4, 5]] > 0.0).all()


def test_an_arm_that_moves_does_not_show_its_angles(vertical):
    """Gravity is not asked, and any acceleration may be."""
    _, x, P = started(vertical, at_rest(vertical, Q), steady=False)
    np.testing.assert_array_equal(x[:6:3], 0.0)
    assert (np.diag(P)[[2, 5]] > 100 * np.diag(started(vertical, at_rest(vertical, Q))[2])[[2, 5]]).all()


def test_a_length_is_as_well_known_as_the_file_says(dd_arm):
    """To a third of itself, and of no less than a decimetre, if it says nothing."""
    of, x, P = started(dd_arm, at_rest(dd_arm, Q))
    a, d = of.length_column[0, 0], of.length_column[1, 1]
    assert np.sqrt(P[a, a]) == pytest.approx(0.25 / 3.0) and np.sqrt(P[d, d]) == pytest.approx(0.1 / 3.0)
    measured = replace(dd_arm, joints=tuple(replace(j, length_std_m=1e-3) for j in dd_arm.joints))
    assert np.sqrt(np.diag(started(measured, at_rest(dd_arm, Q))[2])[[a, d]]) == pytest.approx(1e-3)
    np.testing.assert_array_equal(x[[a, d]], 0.0)


def test_an_ac_coupled_sensor_stands_where_it_is_read(vertical):
    """It settles at what it reads first; gravity's share of that is gone, so the angles stay as given."""
    coupled = replace(vertical, sensors=tuple(replace(s, highpass_hz=0.1) for s in vertical.sensors))
    first = 0.01 * np.arange(12.0)
    of, x, P = started(coupled, first, Q, MountingPrior())
    np.testing.assert_allclose(x[6:18] + at_rest(vertical, Q), first, rtol=0, atol=1e-12)
    for s, settled in enumerate(of.settled_column):
        np.testing.assert_allclose(x[settled : settled + 3], first[3 * s : 3 * s + 3])
        assert np.sqrt(P[of.corner_column[s], of.corner_column[s]]) == pytest.approx(0.3 * 2 * np.pi * 0.1)
    assert np.sqrt(np.diag(P)[6:18]).min() > 9.8


def test_mountings_are_held_as_told(dd_arm):
    of, x, P = started(dd_arm, at_rest(dd_arm, Q), Q, MountingPrior(0.03, 0.02, 0.01))
    for first in of.mounting_column:
        np.testing.assert_array_equal(x[first : first + MOUNTING], 0.0)
        std = np.sqrt(np.diag(P)[first : first + MOUNTING])
        np.testing.assert_allclose(std, np.repeat([0.03, 0.02, 0.01], 3))


def test_covariance_is_one(vertical, spatial):
    for arm, q in ((vertical, Q), (spatial, np.array([0.1, 0.2, 0.3]))):
        still = np.zeros((1, arm.n_joint))
        first = specific_force(arm, q[None], still, still).ravel()
        P = started(arm, first)[2]
        np.testing.assert_array_equal(P, P.T)
        assert np.linalg.eigvalsh(P).min() > 0.0


def test_what_is_known_of_mountings_changes_nothing_where_they_are_not_asked_for(vertical):
    known = SensorCovariance(("s1 scale_x", "s2 turn_z"), ((4.0,), (0.0, 9.0)))
    _, x, P = started(vertical, at_rest(vertical, Q))
    _, known_x, known_P = started(replace(vertical, sensor_covariance=known), at_rest(vertical, Q))
    np.testing.assert_array_equal(known_x, x)
    np.testing.assert_array_equal(known_P, P)


def test_what_is_known_of_mountings_takes_the_place_of_what_is_held_of_them(vertical):
    known = SensorCovariance(("s1 scale_x", "s2 turn_z"), ((4.0,), (0.5, 9.0)))
    arm = replace(vertical, sensor_covariance=known)
    of, _, P = started(arm, at_rest(vertical, Q), mounting=MountingPrior())
    scale, turn = of.mounting_column[0], of.mounting_column[1] + 5  # scale, turn, place; x, y, z of each
    assert (P[scale, scale], P[turn, turn], P[scale, turn], P[turn, scale]) == (4.0, 9.0, 0.5, 0.5)


@pytest.mark.parametrize("seed", range(5))
def test_angles_that_gravity_hardly_shows_stay_near_the_zero(dd_arm, seed):
    """A plane off level by a minute of arc tells less of them than is known without."""
    hardly = replace(dd_arm, gravity_m_s2=(0.0, 0.003, 9.80665))
    offset = 0.02 * np.random.default_rng(seed).normal(size=12)
    _, x, _ = started(hardly, at_rest(hardly, np.zeros(2)) + offset)
    assert np.abs(x[:6:3]).max() < GUESSED_STD


@pytest.mark.parametrize(
    ("size", "std"),
    [
        *((0.0, 0.02), (0.005, 0.02), (0.1, 2.0 * np.sqrt(12.0 * 0.1**2 / 10.0))),
        *((0.2, 2.0 * 0.2 * np.sqrt(1.2)), (1.0, 0.5)),
    ],
)
def test_offsets_are_held_to_be_twice_what_the_first_readings_show(dd_arm, size, std):
    """Of twelve readings that two angles explain a part of, ten are left."""
    first = at_rest(dd_arm, Q) + size
    P = started(dd_arm, first, Q)[2]
    np.testing.assert_allclose(np.sqrt(np.diag(P)[6:18]), std, rtol=1e-9)
    moving = started(dd_arm, first, Q, steady=False)[2]
    np.testing.assert_allclose(np.sqrt(np.diag(moving)[6:18]), 0.2)


def test_too_few_readings_show_no_offsets(spatial):
    """Three angles explain whatever one sensor reads."""
    one, two = (replace(spatial, sensors=spatial.sensors[-n:], tip=None) for n in (1, 2))
    for arm, std in ((one, 0.2), (two, 2.0 * np.sqrt(6.0 * 0.1**2 / 3.0))):
        q = np.array([0.1, 0.2, 0.3])
        still = np.zeros((1, 3))
        first = specific_force(arm, q[None], still, still).ravel() + 0.1
        P = started(arm, first, q)[2]
        np.testing.assert_allclose(np.sqrt(np.diag(P)[9 : 9 + 3 * len(arm.sensors)]), std)


@pytest.mark.parametrize(("steady", "speed", "acceleration"), [(True, 0.01, 0.05), (False, 5.0, 10.0)])
def test_an_arm_at_rest_is_slow_and_a_moving_one_any_speed(vertical, steady, speed, acceleration):
    std = np.sqrt(np.diag(started(vertical, at_rest(vertical, Q), Q, steady=steady)[2]))
    np.testing.assert_allclose(std[[1, 4]], speed)
    np.testing.assert_allclose(std[[2, 5]], acceleration)


@pytest.mark.parametrize(("q", "stds"), [(None, (1e-5, 1.0)), (Q, (GIVEN_STD, GIVEN_STD))])
def test_a_moving_arm_counts_only_its_heading_from_the_start(dd_arm, q, stds):
    """No motion shows the first angle of a level arm; the second one bends the path of the forearm."""
    P = started(dd_arm, at_rest(dd_arm, Q), q, steady=False)[2]
    np.testing.assert_allclose(np.sqrt(np.diag(P)[:6:3]), stds, rtol=1e-6)


@pytest.mark.parametrize("gravity", [(0.0, -9.80665, 0.0), (0.0, -0.3, 0.0), (0.2, 0.1, 0.0)])
@pytest.mark.parametrize("seed", range(3))
def test_gravity_s_angles_are_the_most_probable_ones(vertical, gravity, seed):
    """By least squares: readings to 0.2 m/s^2, angles to a radian of where it is said to rest."""
    arm, rng = replace(vertical, gravity_m_s2=gravity), np.random.default_rng(seed)
    guess = rng.uniform(-0.5, 0.5, 2)
    first = at_rest(arm, Q) + 0.05 * rng.normal(size=12)

    def misses(q):
        return np.concatenate([(at_rest(arm, q) - first) / 0.2, (q - guess) / 1.0])

    of, size = observation_of(arm, False)
    x, _ = start_state(arm, of, size, resting(first), guess, False, MountingPrior())
    expected = least_squares(misses, guess, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    np.testing.assert_allclose(x[:6:3], expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize(("gravity", "std"), [(0.013, 1e-5), (0.015, 1.0)])
def test_an_angle_is_shown_where_readings_tell_more_than_a_guess(gravity, std):
    """Two sensors that read gravity to 0.02 m/s^2 tell it to a radian where it is 0.0141 m/s^2."""
    sensors = (Sensor("s1", 1, (0.1, 0.0, 0.0)), Sensor("s2", 1, (0.2, 0.0, 0.0)))
    arm = Arm("one", (Joint(a_m=0.3),), sensors=sensors, gravity_m_s2=(0.0, -gravity, 0.0))
    P = started(arm, at_rest_of_one(arm))[2]
    assert np.sqrt(P[0, 0]) == pytest.approx(std)


def at_rest_of_one(arm):
    nothing = np.zeros((1, 1))
    return specific_force(arm, nothing, nothing, nothing).ravel()


def test_of_an_ac_coupled_sensor_nothing_is_known_but_where_it_settles(vertical):
    coupled = replace(vertical.sensors[0], highpass_hz=0.1)
    arm = replace(vertical, sensors=(coupled, *vertical.sensors[1:]))
    of, x, P = started(arm, at_rest(vertical, Q), Q)
    std = np.sqrt(np.diag(P))
    np.testing.assert_allclose(std[6:9], 20.0)
    np.testing.assert_allclose(std[9:18], 0.02)  # of the others as ever
    settled = int(of.settled_column[0])
    np.testing.assert_allclose(std[settled : settled + 3], 0.002)
    np.testing.assert_allclose(x[9:18], 0.0, atol=1e-12)
