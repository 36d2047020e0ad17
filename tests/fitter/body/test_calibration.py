"""A person whose lengths are known, from a stance and some squats."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.body.calibration import calibrate_body
from limbcal.errors import NotIdentifiable


def test_markers_are_followed_to_their_noise_but_for_what_hands_and_feet_leave_open(person, fit):
    rms = np.sqrt(np.nanmean(fit.marker_errors([person.recording], 0).distance_m ** 2))
    assert fit.bundle.converged and rms < 2.5e-3


@pytest.mark.parametrize("name", ["thigh_right", "shank_left", "upper_arm_left"])
def test_lengths_are_the_persons_not_the_presets(person, found, name):
    length, true = found["lengths_m"][name], person.lengths_m[name]
    assert length["value"] == pytest.approx(true, abs=1.96 * length["std"]) and length["std"] < 0.011


def test_squats_without_a_stance_are_said(person, fit):
    squats = replace(person.recording, positions=person.recording.positions[75:125])
    found = calibrate_body([squats], person.marker_set, fit_frames=12)
    assert [note.kind for note in found.notes].count("stance") == 1
    assert "stance" not in [note.kind for note in fit.notes]


def test_a_pelvis_without_left_and_right_is_refused(person):
    one_sided = {
        name: m for name, m in person.marker_set.landmarks.items() if "asis" not in name and "psis" not in name
    }
    with pytest.raises(NotIdentifiable, match="asis_right and asis_left"):
        calibrate_body([person.recording], replace(person.marker_set, landmarks=one_sided), fit_frames=20)
