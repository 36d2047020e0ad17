"""How far bodies are from the ground's force, in newtons that were put in."""

import numpy as np
import pytest

from benchmarks.simulated_people.ground import BASE, PERSON, moving, other_masses, trial_of
from fitter.ground.ground_score import ground_score, worse_than_nothing
from fitter.ground.plate_calibration import PlateCalibration

RIGHT = PlateCalibration(np.zeros(6), np.zeros(6))


@pytest.fixture(scope="module")
def trial():
    rng = np.random.default_rng(0)
    theta = other_masses(BASE, rng)
    q = moving(PERSON, rng, 6.0)
    return trial_of(PERSON, BASE, q, q, theta, np.zeros((len(q), 6))), theta


def off(trial, theta, size):
    """Return a trial whose wrench is off by a slow cosine of known rms [N], [N m]."""
    n = len(trial.t)
    wave = np.cos(np.pi * 4 * (np.arange(n) + 0.5) / n)[:, None] * np.array(size)
    return type(trial)(**{**trial.__dict__, "wrench": trial.Y @ theta + wave})


def test_true_bodies_leave_what_was_added(trial):
    one, theta = trial
    made = off(one, theta, [3.0, 0.0, 4.0, 0.0, 2.0, 0.0])
    score = ground_score(PERSON, BASE, [made, made], BASE.links.ravel(), theta, RIGHT, 6.0)
    assert score.force_rms_N[1] == pytest.approx(5.0 / np.sqrt(2.0))
    assert score.moment_rms_N_m[1] == pytest.approx(2.0 / np.sqrt(2.0))
    assert score.force_rms_N[0] > 10.0
    said = score.document()
    assert said["after"] == {"force_rms_N": score.force_rms_N[1], "moment_rms_N_m": score.moment_rms_N_m[1]}
    assert said["before"]["force_rms_N"] == score.force_rms_N[0]
    gone = said["squared_reduction"]
    assert gone["force"] == pytest.approx(1.0 - (score.force_rms_N[1] / score.force_rms_N[0]) ** 2)
    assert gone["moment"] == pytest.approx(1.0 - (score.moment_rms_N_m[1] / score.moment_rms_N_m[0]) ** 2)


def test_what_plates_are_off_by_is_taken_off_where_it_was_learnt(trial):
    one, theta = trial
    made = type(one)(**{**one.__dict__, "wrench": one.Y @ theta + np.array([3.0, -4.0, 0.0, 0.0, 0.0, 0.0])})
    off = PlateCalibration(np.array([0.0, 0.0, 0.0, 3.0, -4.0, 0.0]), np.ones(6))
    score = ground_score(PERSON, BASE, [made], 1.1 * theta, theta, off, 6.0)
    assert score.force_rms_N[1:] == pytest.approx((5.0, 0.0), abs=1e-9)
    assert score.squared_reduction(1)["force"] < score.squared_reduction(2)["force"]
    assert score.document()["with_plates"]["squared_reduction"]["force"] == pytest.approx(1.0)


def test_joints_that_slide_take_the_force_along_them(trial):
    one, theta = trial
    made = off(one, theta, [3.0, 0.0, 4.0, 0.0, 0.0, 0.0])
    score = ground_score(PERSON, BASE, [made], theta, theta, RIGHT, 6.0)
    axes = [one.motions[i].R[0, :, 2] for i in BASE.joints[:3]]
    expected = [abs(axis @ [3.0, 0.0, 4.0]) / np.sqrt(2.0) for axis in axes]
    np.testing.assert_allclose(score.joint_rms[:3], expected, atol=1e-9)
    assert np.all(score.explained <= 1.0) and score.explained[:3].max() > 0.99


def test_what_is_faster_than_the_corner_does_not_count(trial):
    one, theta = trial
    n = len(one.t)
    wave = np.cos(np.pi * (n // 2) * (np.arange(n) + 0.5) / n)[:, None] * np.ones(6)
    made = type(one)(**{**one.__dict__, "wrench": one.Y @ theta + wave})
    score = ground_score(PERSON, BASE, [made], theta, theta, RIGHT, 6.0)
    assert max(score.force_rms_N[1], score.moment_rms_N_m[1]) < 1e-9


def judged(theta, found):
    rng = np.random.default_rng(1)
    q = moving(PERSON, rng, 4.0)
    trial = trial_of(PERSON, BASE, q, q, theta, np.zeros((len(q), 6)))
    return ground_score(PERSON, BASE, [trial], theta, found, RIGHT, 2.0)


def test_the_true_bodies_explain_all():
    theta = other_masses(BASE, np.random.default_rng(0))
    score = judged(theta, theta)
    assert np.allclose(score.explained, 1.0)
    assert worse_than_nothing(BASE, {"learn": score, "evaluate": None}) == ()


def test_bodies_worse_than_none_are_named_by_joint():
    theta = other_masses(BASE, np.random.default_rng(0))
    score = judged(theta, -0.1 * theta)  # leaves 1.1 times what was there
    notes = worse_than_nothing(BASE, {"learn": score, "evaluate": score})
    assert len(notes) == 12 and {note.kind for note in notes} == {"unexplained"}
    assert "joint 1 the learnt bodies predict the ground's reaction in the learning trials" in notes[0].text
    assert "121 % of its power" in notes[0].text
