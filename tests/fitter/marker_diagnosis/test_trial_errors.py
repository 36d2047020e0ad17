"""Errors of a recording's markers, second by second, and against the motion that the others show."""

import numpy as np
import pytest

from benchmarks.simulated_people.person import RATE_HZ, person, with_markers
from fitter.limb.marked_arm import marked_arm
from fitter.marker_diagnosis.trial_errors import trial_errors


@pytest.fixture(scope="module")
def truth():
    return person(n=125, noise_m=2e-3, seed=11)


@pytest.fixture(scope="module")
def arm():
    return with_markers(person(n=125, noise_m=0.0, seed=11))


@pytest.fixture(scope="module")
def errors(arm, truth):
    return trial_errors(arm, truth.recordings[0], 1)


def test_seconds_are_counted_and_their_squares_add_up(truth, errors):
    assert errors.n_block == 3
    assert np.bincount(errors.block).tolist() == [int(RATE_HZ), int(RATE_HZ), 25]
    seen = np.isfinite(errors.y).all(axis=2)
    assert errors.squares.shape == (3, len(errors.names)) and seen.all()
    rms = np.sqrt(errors.squares.sum() / seen.sum())
    assert 0.8 * 2e-3 < rms < np.sqrt(3.0) * 2e-3  # noise along three axes, less what the angles take up


def test_means_weigh_by_information(errors):
    m = errors.names.index("upper_arm_right1")
    weight, error = errors.out.information[:, m], errors.out.error[:, m]
    expected = np.linalg.solve(weight.sum(axis=0), np.einsum("nij,nj->i", weight, error))
    np.testing.assert_allclose(errors.mean[m], expected, rtol=1e-9)
    first = errors.block == 0
    expected = np.linalg.solve(weight[first].sum(axis=0), np.einsum("nij,nj->i", weight[first], error[first]))
    np.testing.assert_allclose(errors.block_means[0, m], expected, rtol=1e-9)
    constant = np.tile([0.01, -0.02, 0.03], (len(errors.y), 1))
    np.testing.assert_allclose(errors.mean_of({m: constant})[m], constant[0], rtol=1e-9)


def test_names_links_and_scales_are_the_arms(arm, errors):
    assert errors.names == marked_arm(arm).names
    joint = {marker.name: marker.joint for marker in arm.markers}
    assert errors.link.tolist() == [joint[name] - 1 for name in errors.names]
    assert errors.std_m == pytest.approx([0.004] * len(errors.names)) and errors.q.shape == (125, 7)


def test_a_marker_that_was_never_seen_tells_nothing(arm, truth):
    name = "hand_right0"
    nothing = np.full((125, 3), np.nan)
    found = trial_errors(arm, truth.recordings[0].with_marker(name, nothing), 1)
    m = found.names.index(name)
    assert (
        np.isnan(found.mean[m]).all() and np.isnan(found.block_means[:, m]).all() and not found.squares[:, m].any()
    )


def test_errors_of_a_marker_left_out_are_those_of_a_fit_without_it(arm, truth, errors):
    """The algebra of leaving out, against tracking a recording that lacks the marker."""
    name = "upper_arm_right2"
    recording = truth.recordings[0]
    m = errors.names.index(name)
    without = trial_errors(arm, recording.with_marker(name, np.full((len(recording.positions), 3), np.nan)), 1)
    predicted = without.out.place[:, m]
    off = recording.of((name,))[:, 0] - predicted
    same = np.einsum("nij,nj->ni", errors.out.axes[:, m], errors.out.error[:, m])
    # the smoother's motion prior holds the frames together, which leaving out frame by frame does not know
    assert np.median(np.linalg.norm(off - same, axis=1)) < 0.25 * np.median(np.linalg.norm(off, axis=1))
