"""Lengths, centres and axes of a whole person, by the kinematics of its tree."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.body.limbs import BODY, MEAN_PERSON
from arm.kinematics import axis_frames
from benchmarks.simulated_people.body import WHERE
from fitter.body.body_map import body_with_limbs
from fitter.body.derived_body import derived_body, limb_geometry, markers_on
from fitter.limb.free_geometry import geometry_of
from fitter.limb.marker_observations import MarkerModel

ARM, LIMBS = body_with_limbs(replace(MEAN_PERSON, preset=BODY))


@pytest.fixture(scope="module")
def markers():
    links = np.repeat(sorted(LIMBS.links.values()), 3).astype(np.int64)
    place = np.random.default_rng(0).normal(size=(len(links), 3))
    return MarkerModel(tuple(f"m{k}" for k in range(len(links))), links, place, np.ones(len(links)), 0)


def test_centres_are_where_the_tree_has_them(markers):
    found = derived_body(LIMBS, geometry_of(ARM), markers, markers.place)
    zero = axis_frames(ARM, np.zeros((1, ARM.n_joint)))[0]
    for name in ("hip_left", "girdle_right", "knee_right", "ankle_left", "elbow_left", "wrist_right"):
        segment, x = found.centres[name]
        T = zero[LIMBS.links[segment]]
        np.testing.assert_allclose(T[:3, :3] @ x + T[:3, 3], zero[WHERE.centres[name], :3, 3], atol=1e-9)
    segment, x = found.centres["lumbar"]
    T = zero[LIMBS.links["pelvis"]]
    assert segment == "pelvis"
    np.testing.assert_allclose(T[:3, :3] @ x + T[:3, 3], zero[LIMBS.lumbar, :3, 3], atol=1e-9)


def test_lengths_are_between_the_centres_of_either_side(markers):
    found = derived_body(LIMBS, geometry_of(ARM), markers, markers.place)
    zero = axis_frames(ARM, np.zeros((1, ARM.n_joint)))[0][:, :3, 3]
    for side in ("right", "left"):
        at = {name: zero[WHERE.centres[f"{name}_{side}"]] for name in ("hip", "knee", "ankle", "elbow", "wrist")}
        for name, begin, end in (
            ("thigh", "hip", "knee"),
            ("shank", "knee", "ankle"),
            ("forearm", "elbow", "wrist"),
        ):
            assert found.lengths[f"{name}_{side}"] == pytest.approx(np.linalg.norm(at[end] - at[begin]))
        assert f"knee_{side}" in found.axes and f"elbow_{side}" in found.axes


def test_a_segments_centres_go_with_its_markers(markers):
    turn, shift = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix(), np.array([0.1, -0.2, 0.3])
    on_it = markers.link == LIMBS.links["pelvis"]
    place = markers.place.copy()
    place[on_it] = (place[on_it] - shift) @ turn  # the fit of all frames is this, turned and shifted
    before = derived_body(LIMBS, geometry_of(ARM), markers, markers.place)
    after = derived_body(LIMBS, geometry_of(ARM), markers, place)
    expected = turn @ before.centres["hip_left"][1] + shift
    np.testing.assert_allclose(after.centres["hip_left"][1], expected, atol=1e-9)
    np.testing.assert_allclose(after.centres["knee_left"][1], before.centres["knee_left"][1], atol=1e-9)


def test_a_limb_by_itself_moves_as_in_the_tree():
    q = 0.3 * np.random.default_rng(1).normal(size=ARM.n_joint)
    q[:6] = 0.0
    zero = axis_frames(ARM, q[None])[0]
    for limb in LIMBS.limbs:
        at = slice(limb.first, limb.first + limb.arm.n_joint)
        geometry = limb_geometry(geometry_of(ARM), limb.first, limb.arm.n_joint)
        assert geometry.parent.tolist()[1:] == [p - limb.first for p in ARM.parents[at]][1:]
        own = limb.arm.with_joints(
            **{name: geometry.numbers[:, k] for k, name in enumerate(("alpha_rad", "a_m", "d_m"))}
        )
        first, last = axis_frames(own, q[None, at])[0][[0, -1], :3, 3]
        there = zero[limb.first, :3, 3], zero[limb.first + limb.arm.n_joint - 1, :3, 3]
        assert np.linalg.norm(last - first) == pytest.approx(np.linalg.norm(there[1] - there[0]), rel=0.05)


def test_changing_a_limbs_numbers_leaves_the_body_alone():
    whole = geometry_of(ARM)
    before = whole.numbers.copy()
    limb_geometry(whole, LIMBS.limbs[0].first, 6).numbers[:] = 0.0
    np.testing.assert_array_equal(whole.numbers, before)


def test_markers_of_a_link_are_named(fit):
    link = LIMBS.links["pelvis"]
    found = markers_on(fit.bundle, link)
    model = fit.bundle.markers
    assert set(found) == {name for name, on in zip(model.names, model.link, strict=True) if on == link}
    for name, place in found.items():
        assert place == model.place[model.names.index(name)].tolist()
