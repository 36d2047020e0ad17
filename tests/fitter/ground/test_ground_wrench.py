"""Plates added up at the world's origin: empty ones, zeros, lost samples."""

import numpy as np
import pytest

from fitter.ground.ground_wrench import ground_wrench
from limbcal.errors import DataError
from protocol.markers.wrench_files import PlateWrench

T = np.arange(200) * 0.01


def plate(force, point=(0.3, 0.1, 0.0), moment=(0.0, 0.0, 2.0)):
    return PlateWrench("plate 1", T, force, np.tile(point, (len(T), 1)), np.tile(moment, (len(T), 1)))


def test_a_force_has_its_moment_about_the_origin():
    force = np.tile([3.0, -4.0, 700.0], (len(T), 1))
    wrench, known, notes = ground_wrench([plate(force)], T[10:-10], "a.mot")
    np.testing.assert_allclose(
        wrench[5], [3.0, -4.0, 700.0, *(np.cross([0.3, 0.1, 0.0], [3.0, -4.0, 700.0]) + [0, 0, 2.0])]
    )
    assert known.all() and not notes


def test_what_an_empty_plate_reads_is_taken_off():
    force = np.where((T > 0.5)[:, None], [0.0, 0.0, 609.0], [0.0, 0.0, 9.0])
    wrench, _, notes = ground_wrench([plate(force, point=(0.0, 0.0, 0.0), moment=(0.0, 0.0, 0.0))], T, "a.mot")
    assert wrench[10, 2] == pytest.approx(0.0) and wrench[-10, 2] == pytest.approx(600.0)
    assert [note.kind for note in notes] == ["plate_zero"]


def test_samples_without_a_number_are_not_known():
    force = np.tile([0.0, 0.0, 600.0], (len(T), 1))
    force[-20:] = np.nan
    _, known, notes = ground_wrench([plate(force)], T, "a.mot")
    assert known[:-20].all() and not known[-19:].any()
    assert notes[0].kind == "nan_forces"


def test_plates_of_another_time_are_refused():
    with pytest.raises(DataError, match="one clock"):
        ground_wrench([plate(np.ones((len(T), 3)))], T + 100.0, "a.mot")


def test_a_hole_does_not_spread_to_what_was_measured():
    t = np.arange(2000) * 0.001
    force = np.tile([0.0, 0.0, 700.0], (len(t), 1))
    force[900:1100] = np.nan
    fast = PlateWrench("plate 1", t, force, np.zeros_like(force), np.zeros_like(force))
    wrench, known, _ = ground_wrench([fast], T, "a.mot")
    assert not known[95:105].any() and known[:85].all()
    np.testing.assert_allclose(wrench[known][:, 2], 700.0, rtol=1e-9)
