"""Upright frames, and how pelvis and thorax stand in their markers then."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.simulated_people.body import RATE_HZ, WORLD, truth
from fitter.body.body_map import body_with_limbs
from fitter.body.stance import bent_knees, stance
from fitter.limb.limb_trials import sorted_trials
from limbcal.errors import NotIdentifiable


def test_the_first_second_is_upright_and_faces_as_the_person_does(fit):
    found = stance(fit.trials)
    assert found.rows[: int(RATE_HZ)].all() and not found.rows[int(1.5 * RATE_HZ) : int(2.5 * RATE_HZ)].any()
    away = np.degrees(np.arccos(np.clip(0.5 * (np.trace(found.world.T @ WORLD) - 1.0), -1.0, 1.0)))
    assert away < 3.0


@pytest.mark.parametrize("segment", ["pelvis", "thorax"])
def test_axes_in_a_segment_are_the_worlds_while_it_stands(fit, segment):
    found = stance(fit.trials)
    R = fit.trials.motions[segment].whole.R[5]
    np.testing.assert_allclose(R @ found.axes[segment], WORLD, atol=0.06)


@pytest.mark.parametrize("segment", ["pelvis", "thorax"])
def test_a_trunk_that_bends_between_squats_has_no_say(segment):
    person = truth(200)  # a fourth of the upright frames are at 3 s, with the trunk bent by 11° to the side
    links = body_with_limbs(person.arm.body)[1].links
    trials = sorted_trials([person.recording], person.marker_set, tuple(links), ("pelvis", "thorax"))
    away = WORLD.T @ trials.motions[segment].whole.R[5] @ stance(trials).axes[segment]
    assert np.degrees(np.arccos(0.5 * (np.trace(away) - 1.0))) < 0.6


@pytest.mark.parametrize("segment", ["pelvis", "thorax"])
def test_a_trunk_without_a_pose_is_refused_with_its_markers(fit, segment):
    motions = {name: motion for name, motion in fit.trials.motions.items() if name != segment}
    with pytest.raises(NotIdentifiable, match=f"the {segment} has {segment}0, .* expected three markers"):
        stance(replace(fit.trials, motions=motions))


def test_knees_that_are_never_straight_are_said():
    knees = np.radians([[3.0, 41.0], [2.0, 40.0], [1.0, 39.0]])
    (note,) = bent_knees(knees)
    assert note.kind == "stance" and "bent by 40°" in note.text
    assert bent_knees(0.4 * knees) == () and bent_knees(knees[:0]) == ()
