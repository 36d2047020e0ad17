"""Where the fit of a person begins: lengths by landmarks, frame 0 the laboratory's."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.limbs import BODY, MEAN_PERSON
from arm.body.whole_body import body_landmarks, human_body
from benchmarks.simulated_people.body import WHERE
from fitter.body.body_map import body_with_limbs
from fitter.body.stance import stance
from fitter.body.start import initial_body
from fitter.functional.anatomy import LANDMARKS
from fitter.limb.inverse_kinematics import link_poses
from fitter.limb.limb_trials import sorted_trials


def test_the_start_has_the_lengths_of_the_landmarks(person, fit):
    numbers = fit.start.geometry.numbers
    shank = WHERE.joints.index("shank_left")
    assert abs(numbers[shank, 2]) == pytest.approx(person.lengths_m["shank_left"], abs=1e-3)


def test_the_pelvis_is_where_it_is_in_the_laboratory(person, fit):
    _, o = link_poses(fit.bundle.markers.chain(fit.bundle.geometry), fit.task.frames, fit.bundle.q)
    middle = 0.5 * (o[:, WHERE.centres["hip_right"]] + o[:, WHERE.centres["hip_left"]])
    true = 0.5 * (person.centres_m["hip_right"] + person.centres_m["hip_left"])[fit.rows]
    assert np.median(np.linalg.norm(middle - true, axis=1)) < 0.015


@pytest.mark.parametrize("side", ["right", "left"])
def test_shoulders_begin_below_the_acromion_though_the_girdle_moves(fit, side):
    geometry, link = fit.start.geometry, WHERE.centres[f"girdle_{side}"]
    across = 3  # the thorax turns about an axis to the left
    beside = abs(geometry.hang[link, across]) + geometry.numbers[link + 1, 1]
    assert beside == pytest.approx(human_body(replace(MEAN_PERSON, preset=BODY)).joints[link + 1].a_m, abs=0.012)


def test_arms_without_a_marker_begin_as_the_preset_has_them(person):
    of_arms = ("scapula", "upper_arm", "forearm", "hand")
    segments = {name: own for name, own in person.marker_set.segments.items() if not name.startswith(of_arms)}
    landmarks = {
        name: m for name, m in person.marker_set.landmarks.items() if not LANDMARKS[name].startswith(of_arms)
    }
    arm, where = body_with_limbs(replace(MEAN_PERSON, preset=BODY))
    own = replace(person.marker_set, segments=segments, landmarks=landmarks)
    trials = sorted_trials([person.recording], own, tuple(where.links), ("pelvis", "thorax"))
    begin = initial_body(arm, where, trials, stance(trials), MEAN_PERSON.height_m)
    assert not [name for name in begin.virtual.names if "arm" in name]
    link = WHERE.centres["elbow_left"] + 1
    assert begin.geometry.numbers[link, 2] == pytest.approx(arm.joints[link].d_m)


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
