"""Platforms that are loaded or not, and forces that are not there."""

import numpy as np

from protocol.markers.force_notes import moves, nan_forces
from protocol.markers.recording import ForceRecord


def plate(force):
    noise = np.random.default_rng(0).normal(size=(2000, 3))
    return ForceRecord("plate 1", 1000.0, noise + np.outer(force, [0.0, 0.0, 1.0]))


def test_a_step_on_a_platform_moves_it_and_noise_about_an_offset_does_not():
    assert moves(plate(600.0 * (np.arange(2000) > 1000)))
    assert not moves(plate(np.full(2000, 9.0)))


def test_forces_that_are_nan_for_a_tenth_of_a_second_are_said():
    record = plate(np.zeros(2000))
    record.channels[500:550] = np.nan
    assert nan_forces((record,)) == []
    record.channels[1800:, 1] = np.nan
    (note,) = nan_forces((record,))
    assert (note.kind, note.columns, note.from_s, note.to_s) == ("nan_forces", ("plate 1",), 1.8, 2.0)


def test_of_a_platform_that_was_heard_twice_nothing_is_known():
    record = plate(np.zeros(2000))
    record.channels[:] = np.nan
    record.channels[:2, 0] = 0.0, 300.0
    assert not moves(record)
    record.channels[2, 0] = 600.0
    assert moves(record)
