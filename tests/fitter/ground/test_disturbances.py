"""Skin and plates: what their columns add to the equations, against bodies that were really displaced."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.body.whole_body import body_map
from arm.model import Marker
from arm.moving_base import standing_base
from benchmarks.simulated_people.ground import BASE, DT, PERSON, moving
from fitter.data.derivatives import both_derivatives
from fitter.ground.disturbances import (
    PLATE_M,
    ZERO_N,
    plate_columns,
    plate_stds,
    postures,
    skin_columns,
    skin_of,
)
from fitter.ground.link_motion import link_motions


@pytest.fixture(scope="module")
def moved():
    q = moving(PERSON, np.random.default_rng(0), 6.0)
    dq, ddq = both_derivatives(q, DT)
    motions = link_motions(PERSON, q, dq, ddq, standing_base(len(q)))
    return q, motions, postures(PERSON, BASE, motions, q, dq, ddq)


INNER = slice(60, -60)


def test_rates_of_postures_are_their_derivatives(moved):
    _, _, found = moved
    assert len(found) == len(BASE.bodies)
    for posture in found:
        rate, second = both_derivatives(posture.value, DT)
        np.testing.assert_allclose(posture.rate[INNER], rate[INNER], atol=2e-3)
        np.testing.assert_allclose(posture.second[INNER], second[INNER], atol=0.05)
        np.testing.assert_allclose(np.linalg.norm(posture.value[:, -3:], axis=1), 1.0)


def test_a_foots_posture_is_that_of_the_joints_before_it(moved):
    q, _, found = moved
    shank, foot = (body_map().parts[name].link for name in ("shank_left", "foot_left"))
    posture = found[BASE.bodies.index(foot)]
    np.testing.assert_array_equal(posture.value[:, :-3], q[:, shank + 1 : foot + 1])


def test_functions_kept_have_no_mean_and_the_size_of_a_posture(moved):
    _, _, found = moved
    skin = skin_of(PERSON, BASE, [found])
    for k, posture in enumerate(found):
        f = (posture.value - skin.mean[k]) @ skin.mix[k]
        np.testing.assert_allclose(f.mean(axis=0), 0.0, atol=1e-9)
        assert np.all(np.sqrt(np.mean(f**2, axis=0)) <= 1.0 + 1e-9)
        np.testing.assert_allclose(f.T @ f, np.diag(np.diag(f.T @ f)), atol=1e-6 * len(f))


def test_without_markers_skin_is_a_usual_segments(moved):
    _, _, found = moved
    skin = skin_of(PERSON, BASE, [found])
    np.testing.assert_allclose(skin.shift_m, 0.006 / np.sqrt(3.0))
    np.testing.assert_allclose(skin.turn_rad, skin.shift_m / 0.1)
    columns = skin_columns(BASE, moved[1], found, skin)
    assert skin.stds().shape == (columns.shape[2],)
    n = skin.mix[0].shape[1]
    assert skin.stds()[:6] == pytest.approx(
        [skin.shift_m[0] / np.sqrt(n)] * 3 + [skin.turn_rad[0] / np.sqrt(n)] * 3
    )


def test_with_markers_it_is_the_error_of_a_rigid_fit(moved):
    """By drawing markers' errors: shift of the centre of mass, turn of the body."""
    body, link = BASE.bodies[1], BASE.links[1]
    places = np.array([[0.1, 0.0, -0.1], [-0.05, 0.08, -0.2], [0.0, -0.1, -0.3], [0.05, 0.05, 0.0]])
    markers = tuple(Marker(f"M{k}", body + 1, tuple(x), 0.01) for k, x in enumerate(places.tolist()))
    skin = skin_of(replace(PERSON, markers=markers), BASE, [moved[2]])
    rng = np.random.default_rng(0)
    centre, middle = link[6:9] / link[9], places.mean(axis=0)
    shifts, turns = [], []
    for _ in range(1000):
        off = 1e-3 * rng.normal(size=places.shape)
        turn, _ = Rotation.align_vectors(places + off - (places + off).mean(axis=0), places - middle)
        turns.append(turn.as_rotvec())
        shifts.append((places + off).mean(axis=0) + turn.apply(centre - middle) - centre)
    assert skin.shift_m[1] == pytest.approx(10.0 * np.sqrt(np.mean(np.square(shifts))), rel=0.08)
    assert skin.turn_rad[1] == pytest.approx(10.0 * np.sqrt(np.mean(np.square(turns))), rel=0.08)
    assert skin.shift_m[0] == pytest.approx(0.006 / np.sqrt(3.0))


def test_a_shift_of_a_centre_adds_what_the_moved_mass_weighs(moved):
    """Force: mass times the second derivative of where the centre is more."""
    _, motions, found = moved
    skin = skin_of(PERSON, BASE, [found])
    columns = skin_columns(BASE, motions, found, skin)
    body = BASE.bodies[0]
    f = (found[0].value - skin.mean[0]) @ skin.mix[0][:, 0]
    for axis in range(3):
        s = motions[body].R[:, :, axis] * f[:, None]
        second = both_derivatives(s, DT)[1]
        force = BASE.links[0, 9] * second
        np.testing.assert_allclose(columns[INNER, :3, axis], force[INNER], atol=0.02 * np.abs(force).max())
        moment = BASE.links[0, 9] * np.cross(s, motions[body].acceleration)  # about its own origin
        np.testing.assert_allclose(columns[INNER, 3:, axis], moment[INNER], atol=0.02 * np.abs(moment).max())


def test_a_turned_body_adds_no_force(moved):
    _, motions, found = moved
    columns = skin_columns(BASE, motions, found, skin_of(PERSON, BASE, [found]))
    assert not columns[:, :3, 3:6].any() and columns[:, 3:, 3:6].any()


def test_plates_off_their_place_add_a_moment_off_their_zero_a_force():
    wrench = np.random.default_rng(0).normal(size=(5, 6))
    columns = plate_columns(wrench)
    shift, zero = np.array([0.01, -0.02, 0.03]), np.array([1.0, 2.0, -3.0])
    added = columns @ np.concatenate([shift, zero])
    np.testing.assert_allclose(added[:, :3], np.tile(zero, (5, 1)))
    np.testing.assert_allclose(added[:, 3:], np.cross(shift, wrench[:, :3]))
    assert plate_stds().tolist() == [PLATE_M] * 3 + [ZERO_N] * 3
