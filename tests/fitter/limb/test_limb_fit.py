"""What a fitted leg says of recordings."""

from dataclasses import replace

import numpy as np
import pytest


def test_errors_of_markers_are_the_noise_they_were_simulated_with(leg):
    found = leg.fit.marker_errors(leg.truth.recordings, 0)
    limb, base = len(leg.fit.bundle.markers.names), len(leg.fit.base.markers)
    assert found.distance_m.shape == (400, limb + base)
    rms = np.sqrt(np.nanmean(found.distance_m**2, axis=0))
    assert rms[:limb].max() < 4e-3 and rms[limb:].max() < 2e-3
    assert found.explained > 0.99


def test_a_marker_that_was_moved_stands_out_alone(leg):
    recording, name = leg.truth.recordings[0], "shank_right1"
    positions = recording.positions.copy()
    positions[:, recording.names.index(name)] += [0.0, 0.0, 0.03]
    found = leg.fit.marker_errors([replace(recording, positions=positions)], 0)
    rms = np.sqrt(np.nanmean(found.distance_m**2, axis=0))
    assert int(np.argmax(rms)) == leg.fit.bundle.markers.names.index(name)
    assert 0.015 < rms.max() < 0.03


def test_frames_without_the_base_are_left_out(leg):
    recording = leg.truth.recordings[0]
    positions = recording.positions.copy()
    positions[50:60, [name.startswith("B") for name in recording.names]] = np.nan
    frames, usable = leg.fit.frames([replace(recording, positions=positions)])
    assert np.flatnonzero(~usable).tolist() == list(range(50, 60)) and len(frames.t) == 190
    origin = leg.truth.R[0][usable] @ leg.truth.base_p + leg.truth.p[0][usable]
    found = frames.R @ leg.fit.bundle.geometry.base_p + frames.p
    assert np.linalg.norm(found - origin, axis=1).max() < 0.01


def test_frames_of_the_fit_are_rows_of_all(leg):
    frames, rows = leg.fit.frames_of_fit()
    assert len(rows) == len(frames.t) == 120
    everything = np.concatenate([r.of(leg.fit.bundle.markers.names) for r in leg.truth.recordings])
    np.testing.assert_array_equal(frames.y, everything[rows])
    assert leg.fit.free is leg.fit.task.free


def test_a_bases_marker_wanders_no_less_than_one_of_the_limb(leg):
    fit = leg.fit
    own = fit.trials.motions["pelvis"]
    assert fit.base_std_m == pytest.approx(max(np.sqrt(own.variance_m2), fit.bundle.markers.std[0]))
    standing = replace(fit, base=replace(fit.base, segment=None))
    assert standing.base_std_m == fit.bundle.markers.std[0]
