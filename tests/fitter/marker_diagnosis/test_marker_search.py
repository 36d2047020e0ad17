"""Faults that are put into a simulated person's recordings are found, and nothing else is."""

import numpy as np
import pytest

from arm.kinematics import axis_frames
from benchmarks.simulated_people.person import person, with_markers
from fitter.marker_diagnosis.marker_search import search_markers


@pytest.fixture(scope="module")
def truth():
    return person(n=150, noise_m=2e-3, seed=11, trials=3)


@pytest.fixture(scope="module")
def arm():
    return with_markers(person(n=150, noise_m=0.0, seed=11))


def shifted(truth, trial, name, by):
    """Return a trial's recording with a marker elsewhere on its link: ``by`` (3,) or (n_frame, 3) [m]."""
    recording = truth.recordings[trial]
    link = {"upper": 2, "fore": 4, "hand": 6}[name.split("_")[0].removesuffix("arm")]
    R = np.einsum("nij,njk->nik", truth.R[trial], axis_frames(truth.arm, truth.q[trial])[:, link, :3, :3])
    moved = np.einsum("nij,nj->ni", R, np.broadcast_to(by, (len(R), 3)))
    return recording.with_marker(name, recording.of((name,))[:, 0] + moved)


def only_cause(arm, recordings):
    (cause,) = search_markers(arm, recordings).causes
    return cause.itself


def test_nothing_is_found_in_sound_recordings(arm, truth):
    assert search_markers(arm, truth.recordings).causes == ()


def test_a_marker_moved_in_one_trial_is_found_with_place_and_trial(arm, truth):
    by = np.array([0.012, -0.015, 0.02])
    wrong = shifted(truth, 1, "upper_arm_right1", by)
    cause = only_cause(arm, [truth.recordings[0], wrong, truth.recordings[2]])
    assert (cause.effect.name, cause.effect.markers, cause.trials) == ("marker_moved", ("upper_arm_right1",), (2,))
    assert cause.effect.parameters["trials"] == [2]
    found = np.array([cause.effect.parameters[name] for name in ("x_m", "y_m", "z_m")])
    np.testing.assert_allclose(found, by, atol=3.0 * max(cause.std.values()))


def test_a_marker_moved_in_all_trials_is_one_cause(arm, truth):
    by = np.array([0.02, 0.01, 0.0])
    cause = only_cause(arm, [shifted(truth, k, "forearm_right0", by) for k in range(3)])
    assert (cause.effect.name, cause.trials) == ("marker_moved", (1, 2, 3))
    assert "trials" not in cause.effect.parameters


def test_exchanged_labels_are_no_moved_markers(arm, truth):
    one, other = "forearm_right1", "radial_styloid_right"
    recordings = list(truth.recordings)
    places = recordings[2].of((one, other))
    recordings[2] = recordings[2].with_marker(one, places[:, 1]).with_marker(other, places[:, 0])
    cause = only_cause(arm, recordings)
    assert (cause.effect.name, set(cause.effect.markers), cause.trials) == ("label_swap", {one, other}, (3,))


def test_skin_that_slides_with_a_joint_is_found(arm, truth):
    slope = np.array([0.0, 0.025, -0.03])
    recordings = [shifted(truth, k, "upper_arm_right0", np.outer(truth.q[k][:, 3] - 1.0, slope)) for k in range(3)]
    cause = only_cause(arm, recordings)
    assert (cause.effect.name, cause.effect.markers) == ("soft_tissue", ("upper_arm_right0",))
    assert cause.effect.parameters["joint"] == 4
    found = np.array([cause.effect.parameters[name] for name in ("x_m_rad", "y_m_rad", "z_m_rad")])
    np.testing.assert_allclose(found, slope, atol=3.0 * max(cause.std.values()))
