"""Centres of joints with their errors, and what a motion leaves open."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fitter.functional.functional_centre import functional_centre
from limbcal.errors import NotIdentifiable
from tests.fitter.functional.poses import recorded, segments, simulated
from tests.fitter.functional.simulated_limb import Limb
from tests.fitter.functional.test_score import HIP

#: Number of draws, and the least coverage of 95 % intervals among them.
DRAWS, LEAST_HELD = 20, 0.85


def distances(segment, point):
    return np.linalg.norm(segment.template.points_m - point, axis=1)


def test_intervals_of_centres_hold_them_although_skin_moves_coherently():
    held = []
    for seed in range(DRAWS):
        limbs, parent, child = simulated("ball", seed, 700, trials=2)
        centre = functional_centre("hip_right", parent, child)
        held.append(np.abs(centre.in_parent_m - parent.place([x.p for x in limbs])) <= centre.half_width_m)
    assert np.mean(held) >= LEAST_HELD


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_rigid_motion_of_the_recording_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    limbs, parent, child = simulated("ball", 1, 400)
    R, p = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    turned = [Limb(x.parent_m @ R.T + p, x.child_m @ R.T + p, x.R, x.p) for x in limbs]
    one = functional_centre("hip_right", parent, child, weighted=True)
    other_parent, other_child = segments(turned)
    other = functional_centre("hip_right", other_parent, other_child, weighted=True)
    assert np.allclose(distances(parent, one.in_parent_m), distances(other_parent, other.in_parent_m), atol=1e-5)
    assert one.std_m == pytest.approx(other.std_m, rel=1e-2)


@settings(max_examples=5, deadline=None)
@given(st.permutations(range(4)))
def test_the_order_of_markers_changes_nothing(order):
    limbs, parent, child = simulated("ball", 2, 400)
    mixed = [Limb(x.parent_m[:, order], x.child_m[:, order], x.R, x.p) for x in limbs]
    one = functional_centre("hip_right", parent, child)
    other_parent, other_child = segments(mixed)
    other = functional_centre("hip_right", other_parent, other_child)
    assert np.allclose(
        distances(parent, one.in_parent_m)[order], distances(other_parent, other.in_parent_m), atol=1e-5
    )


@pytest.mark.parametrize("scale", [0.7, 1.4])
def test_a_larger_person_has_a_larger_everything(scale):
    limbs, parent, child = simulated("ball", 3, 400)
    grown = [Limb(scale * x.parent_m, scale * x.child_m, x.R, x.p) for x in limbs]
    one = functional_centre("hip_right", parent, child)
    other_parent, other_child = segments(grown)
    other = functional_centre("hip_right", other_parent, other_child)
    expected = scale * distances(parent, one.in_parent_m)
    assert np.allclose(expected, distances(other_parent, other.in_parent_m), atol=1e-5)
    assert other.std_m == pytest.approx(scale * one.std_m, rel=1e-2)


def test_which_segment_is_called_the_parent_changes_nothing():
    _, parent, child = simulated("ball", 4, 600)
    one, other = functional_centre("hip_right", parent, child), functional_centre("hip_right", child, parent)
    assert np.allclose(one.in_parent_m, other.in_child_m, atol=1e-9)
    assert np.allclose(one.in_child_m, other.in_parent_m, atol=1e-9)


def test_a_hinge_is_told_with_the_motion_that_would_reveal_the_centre():
    _, parent, child = simulated("hinge", 5)
    centre = functional_centre("knee_right", parent, child)
    note = centre.notes[0]
    assert note.kind == "hinge"
    assert "bend the knee over 60° and turn the shank" in note.text
    assert np.isinf(centre.half_width_m).any()


def test_segments_that_are_never_seen_together_are_refused():
    limbs, _, _ = simulated("ball", 8, 400)
    limbs[0].parent_m[:200] = np.nan
    limbs[0].child_m[200:] = np.nan
    with pytest.raises(NotIdentifiable, match="200 and 200 frames have a pose, none together"):
        functional_centre("hip_right", *segments(limbs))


def test_a_parent_that_does_not_move_is_a_parent():
    limbs, _, _ = simulated("ball", 9, 800, skin_m=0.0, skin_rad=0.0)
    x = limbs[0]
    fixed = np.einsum(
        "nji,nmj->nmi", x.R, x.child_m - x.p[:, None]
    )  # the world turned into the parent's own frame
    base = np.einsum("nji,nmj->nmi", x.R, x.parent_m - x.p[:, None])
    parent, child = segments([Limb(base, fixed, x.R, x.p)])
    centre = functional_centre("shoulder_right", parent, child)
    assert np.allclose(parent.trials[0].to_world(centre.in_parent_m).mean(axis=0), 0.0, atol=1e-3)


def test_halves_of_a_hip_trial_agree():
    hip = recorded("btk/FunctionalLHip.c3d", HIP)
    centre = functional_centre("hip_left", hip["pelvis"], hip["thigh_left"])
    assert centre.apart_m < 0.008
    assert not centre.unobservable.any()


def test_the_document_has_what_the_design_promises():
    _, parent, child = simulated("ball", 10, 1500)
    document = functional_centre("hip_right", parent, child).document(parent)
    assert document["segment"] == "thigh_right"
    assert set(document["markers_m"]) == set(parent.template.markers)
    assert 0.0 < document["std_mm"] < 50.0 and 0.0 < document["apart_mm"] < 100.0


def test_an_error_from_one_trial_says_so():
    _, parent, child = simulated("ball", 11, 600)
    assert [note.kind for note in functional_centre("hip_right", parent, child).notes] == ["one_trial"]
    _, parent, child = simulated("ball", 11, 900, trials=2)
    assert functional_centre("hip_right", parent, child).notes == ()
