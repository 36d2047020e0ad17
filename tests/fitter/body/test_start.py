"""Where the fit of a person begins: lengths by landmarks, frame 0 the laboratory's."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.limbs import BODY, MEAN_PERSON
from arm.body.whole_body import body_landmarks
from fitter.body.body_map import body_with_limbs
from fitter.body.stance import stance
from fitter.body.start import initial_body
from fitter.limb.inverse_kinematics import link_poses
from fitter.limb.limb_trials import sorted_trials
from tests.fitter.body.simulated_body import WHERE


def test_the_start_has_the_lengths_of_the_landmarks(person, fit):
    numbers = fit.start.geometry.numbers
    knee = WHERE.centres["knee_left"]
    assert numbers[knee, 1] == pytest.approx(person.lengths_m["shank_left"], abs=1e-3)


def test_the_pelvis_is_where_it_is_in_the_laboratory(person, fit):
    _, o = link_poses(fit.bundle.markers.chain(fit.bundle.geometry), fit.task.frames, fit.bundle.q)
    middle = 0.5 * (o[:, WHERE.centres["hip_right"]] + o[:, WHERE.centres["hip_left"]])
    true = 0.5 * (person.centres_m["hip_right"] + person.centres_m["hip_left"])[fit.rows]
    assert np.median(np.linalg.norm(middle - true, axis=1)) < 0.015


def test_hips_that_nothing_shows_begin_below_the_spines_in_front(person):
    landmarks = {name: m for name, m in person.marker_set.landmarks.items() if "psis" not in name}
    recording = replace(person.recording, positions=person.recording.positions[:40])  # upright: nothing turns
    arm, where = body_with_limbs(replace(MEAN_PERSON, preset=BODY))
    trials = sorted_trials(
        [recording], replace(person.marker_set, landmarks=landmarks), tuple(where.links), ("pelvis",)
    )
    begin = initial_body(arm, where, trials, stance(trials), MEAN_PERSON.height_m)
    pelvis = begin.virtual.place[begin.virtual.names.index("asis_right")]
    link, about = body_landmarks(arm)["asis_right"]
    assert np.linalg.norm(pelvis - about) < 0.02 and begin.virtual.link[0] == link
