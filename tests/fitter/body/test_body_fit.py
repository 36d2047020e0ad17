"""How far a person's markers are from the fitted tree."""

from dataclasses import replace

import numpy as np


def test_distances_are_frame_by_frame_and_the_motion_is_explained(person, fit):
    found = fit.marker_errors([person.recording], 0)
    assert found.distance_m.shape == (len(person.recording.positions), len(fit.bundle.markers.names))
    assert found.explained > 0.99


def test_a_marker_that_was_moved_stands_out_alone(person, fit):
    name = "thigh_left0"
    positions = person.recording.positions[:100].copy()
    positions[:, person.recording.names.index(name)] += [0.0, 0.03, 0.0]
    found = fit.marker_errors([replace(person.recording, positions=positions)], 0)
    rms = np.sqrt(np.nanmean(found.distance_m**2, axis=0))
    assert int(np.argmax(rms)) == fit.bundle.markers.names.index(name) and 0.01 < rms.max() < 0.03


def test_a_marker_that_is_hidden_has_no_distance(person, fit):
    name = "thigh_left0"
    positions = person.recording.positions[:60].copy()
    positions[20:30, person.recording.names.index(name)] = np.nan
    found = fit.marker_errors([replace(person.recording, positions=positions)], 0).distance_m
    own = found[:, fit.bundle.markers.names.index(name)]
    assert np.flatnonzero(np.isnan(own)).tolist() == list(range(20, 30))
