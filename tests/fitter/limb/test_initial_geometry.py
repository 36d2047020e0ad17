"""Where the bundle fit begins: lengths and places of a person, priors in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.landmarks import LANDMARK_STD_M, centre_points, limb_map
from arm.body.limbs import MEAN_PERSON, limb
from fitter.limb.base_motion import BaseMotion, base_motion
from fitter.limb.centres import Centre, joint_centres
from fitter.limb.free_geometry import CENTRE_M, LENGTH_SHARE, geometry_of
from fitter.limb.initial_geometry import (
    angle_prior,
    first_angles,
    initial_geometry,
    joint_prior,
    placed,
    sway_std,
    virtual_markers,
    with_lengths,
)
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import SWAY, Frames

LEG = limb(replace(MEAN_PERSON, preset="human-leg-right"))
WHERE = limb_map("human-leg-right", 6)
ARM = limb(replace(MEAN_PERSON, preset="human-arm-left"), "thorax")
OF_ARM = limb_map("human-arm-left", 9)


@pytest.fixture(scope="module")
def begun(leg):
    trials = leg.fit.trials
    base = base_motion(trials, "pelvis")
    centres, _, _ = joint_centres(trials, WHERE)
    axes = base.R[0].T @ leg.truth.R[0][0]  # frame 0 as the simulation has it
    return trials, base, axes, centres


def test_the_start_has_the_persons_lengths_and_hip(leg, begun):
    trials, base, axes, centres = begun
    begin = initial_geometry(LEG, WHERE, trials, base, axes, centres, 1.741)
    assert abs(begin.geometry.numbers[2, 2]) == pytest.approx(abs(leg.truth.arm.joints[2].d_m), abs=0.012)
    assert begin.geometry.numbers[3, 1] == pytest.approx(leg.truth.arm.joints[3].a_m, abs=0.012)
    hip = base.R @ begin.geometry.base_p + base.p
    true = np.concatenate([R @ leg.truth.base_p + p for R, p in zip(leg.truth.R, leg.truth.p, strict=True)])
    assert np.median(np.linalg.norm(hip - true, axis=1)) < 0.008
    assert begin.centre_std_m == 0.02 and begin.length_std_m == (0.015, 0.015)
    frames, rows = leg.fit.frames_of_fit()
    q = first_angles(begin, frames, rows, 0)
    true_q = np.concatenate(leg.truth.q)[rows]
    assert np.median(np.abs(q[:, SWAY:] - true_q)) < 0.15
    names, links = leg.fit.bundle.markers.names, leg.fit.bundle.markers.link
    away = placed(begin, names, links, frames, q) - leg.fit.bundle.markers.place
    assert np.median(np.linalg.norm(away, axis=1)) < 0.03


def test_without_a_centre_the_hip_is_near_the_thigh(leg, begun):
    trials, base, axes, _ = begun
    begin = initial_geometry(LEG, WHERE, trials, base, axes, {}, 1.741)
    assert begin.centre_std_m == 4.0 * CENTRE_M
    y = np.mean([trials.of(m) for m in trials.segments["thigh_right"]], axis=0)
    middle = np.median(np.einsum("nji,nj->ni", base.R, y - base.p), axis=0)
    np.testing.assert_allclose(begin.geometry.base_p, 0.5 * middle, atol=1e-3)


def test_lengths_are_the_distances_between_centres():
    def at(*x):
        return Centre("score", 0.02, {}, {"thigh_right": np.array(x), "shank_right": np.array(x)})

    arm, std = with_lengths(LEG, WHERE, {"hip": at(0, 0, 0), "knee": at(0, 0.3, 0.4)})
    assert abs(arm.joints[2].d_m) == pytest.approx(0.5) and arm.joints[2].d_m * LEG.joints[2].d_m > 0.0
    assert arm.joints[3].a_m == LEG.joints[3].a_m
    assert std == pytest.approx((0.015, LENGTH_SHARE * LEG.joints[3].a_m))
    arm, _ = with_lengths(LEG, WHERE, {"knee": at(0, 0, 0), "ankle": at(0, 0, 0.45)})
    assert arm.joints[3].a_m == pytest.approx(0.45) and arm.joints[2].d_m == LEG.joints[2].d_m


def test_an_arm_with_a_girdle_has_a_third_length():
    place = {"upper_arm_left": np.zeros(3)}
    far = {"upper_arm_left": np.array([0.0, 0.31, 0.0]), "forearm_left": np.zeros(3)}
    wrist = {"forearm_left": np.array([0.0, 0.0, 0.27])}
    centres = {
        name: Centre("score", 0.02, {}, x) for name, x in {"shoulder": place, "elbow": far, "wrist": wrist}.items()
    }
    arm, std = with_lengths(ARM, OF_ARM, centres)
    assert abs(arm.joints[4].d_m) == pytest.approx(0.31) and abs(arm.joints[6].d_m) == pytest.approx(0.27)
    assert std == pytest.approx((LENGTH_SHARE * ARM.joints[1].a_m, 0.015, 0.015))


def test_angles_lie_about_the_middle_of_their_range_and_balls_anywhere():
    prior = joint_prior(LEG, WHERE.balls)
    assert prior.mean[:3].tolist() == [0.0] * 3 and prior.information[:3] == pytest.approx([0.25] * 3)
    low, high = LEG.joints[3].limits
    assert prior.mean[3] == 0.5 * (low + high)
    assert prior.information[3] ** -0.5 == pytest.approx(max(0.5 * (high - low), 0.5))
    free = joint_prior(ARM, (), n_floating=1)
    assert free.mean[0] == 0.0 and free.information[0] == 0.25
    whole = angle_prior(LEG, WHERE, 0.01)
    assert whole.information[:3] ** -0.5 == pytest.approx([0.01] * 3) and len(whole.mean) == SWAY + 6
    np.testing.assert_array_equal(whole.mean[SWAY:], prior.mean)


def test_a_base_sways_by_what_its_markers_leave_open():
    """Of n markers a place at their middle is off by skin over the root of n, one far away by more."""
    points = 0.1 * np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])

    def of(n):
        return BaseMotion("pelvis", tuple("abcd"[:n]), points[:n], np.eye(3)[None], np.zeros((1, 3)))

    assert sway_std(of(4), np.zeros(3)) == pytest.approx(0.008 / 2.0)
    assert sway_std(of(4), np.zeros(3)) < sway_std(of(4), np.array([0.0, 0.0, 0.1])) < 0.02
    assert sway_std(of(4), np.array([0.0, 0.0, 9.0])) == 0.02
    assert sway_std(of(2), np.zeros(3)) == 0.008 and sway_std(of(0), np.zeros(3)) == 1e-5


def test_virtual_markers_are_the_presets_where_it_has_them(begun):
    trials, _, _, centres = begun
    model, points = virtual_markers(LEG, WHERE, trials, centres, 1.741)
    assert points.shape == (len(trials.whole), len(model.names), 3)
    known = dict(zip(model.names, zip(model.link.tolist(), model.place, model.std, strict=True), strict=True))
    assert known["lateral_malleolus_right"][0] == 3 and known["lateral_malleolus_right"][2] == LANDMARK_STD_M
    frames = Frames(
        np.zeros((1, len(model.names), 3)), np.eye(3)[None], np.zeros((1, 3)), np.zeros(1, int), np.zeros(1)
    )
    zero = predicted(model.chain(geometry_of(LEG)), frames, np.zeros((1, SWAY + 6)))[0]
    for name, x in zip(model.names, zero, strict=True):
        if name in ("hip", "knee", "ankle"):
            np.testing.assert_allclose(x, centre_points(LEG, WHERE)[name], atol=1e-9)
