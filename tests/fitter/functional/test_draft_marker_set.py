"""Drafts of marker sets from recordings."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fitter.functional.draft_marker_set import distance_scatter, draft_marker_set
from fitter.functional.marker_set import parse_marker_set
from limbcal.errors import ConfigError, DataError
from tests.fitter.functional.poses import simulated

NAMES = ("P1", "C1", "P2", "C2", "P3", "C3", "P4", "C4")


def recording(seed: int, kind: str = "ball", **noise: float):
    limbs, _, _ = simulated(kind, seed, 1200, **noise)
    x = np.empty((1200, 8, 3))
    x[:, 0::2], x[:, 1::2] = limbs[0].parent_m, limbs[0].child_m
    return x


def clusters(draft):
    return {frozenset(cluster) for cluster in draft.clusters}


BOTH = {frozenset(("P1", "P2", "P3", "P4")), frozenset(("C1", "C2", "C3", "C4"))}


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["ball", "hinge"]))
def test_markers_of_a_segment_are_one_cluster(seed, kind):
    x = recording(seed, kind)
    rng = np.random.default_rng(seed)
    x[rng.uniform(size=x.shape[:2]) < 0.3] = np.nan
    R = Rotation.random(random_state=rng).as_matrix()
    assert clusters(draft_marker_set(NAMES, [x])) == BOTH
    assert clusters(draft_marker_set(NAMES, [x @ R.T + 1.0])) == BOTH
    order = rng.permutation(8)
    assert clusters(draft_marker_set([NAMES[i] for i in order], [x[:600, order], x[600:, order]])) == BOTH


def test_labels_that_are_swapped_for_a_while_change_nothing():
    x = recording(1)
    x[100:250, [0, 1]] = x[100:250, [1, 0]]
    assert clusters(draft_marker_set(NAMES, [x])) == BOTH


def test_a_marker_that_is_seldom_seen_stays_alone():
    x = recording(2)
    x[30:, 7] = np.nan
    assert frozenset(("C4",)) in clusters(draft_marker_set(NAMES, [x]))


def test_somebody_who_stands_still_cannot_be_drafted():
    x = np.repeat(recording(3)[:1], 100, axis=0)
    with pytest.raises(
        DataError, match="keep to 0 mm, expected a recording in which the person moves every joint"
    ):
        draft_marker_set(NAMES, [x])


def test_markers_that_are_never_together_cannot_be_drafted():
    x = np.full((80, 2, 3), np.nan)
    x[:40, 0], x[40:, 1] = 0.0, 1.0
    with pytest.raises(DataError, match="no two markers are seen together"):
        draft_marker_set(["A", "B"], [x])


def test_scatter_is_that_of_distances():
    rng = np.random.default_rng(4)
    x = np.zeros((5000, 2, 3))
    x[:, 1, 0] = 1.0 + 0.01 * rng.normal(size=5000)
    assert distance_scatter(x)[0, 1] == pytest.approx(0.01, rel=0.05)


def test_the_draft_is_a_marker_set_as_soon_as_its_clusters_are_named():
    text = draft_marker_set(NAMES, [recording(5)]).toml('lab "A"')
    with pytest.raises(ConfigError, match="segments.cluster_1: no such segment"):
        parse_marker_set(text, "draft.toml")
    named = parse_marker_set(text.replace("cluster_1", "pelvis").replace("cluster_2", "thigh_left"), "draft.toml")
    assert named.name == 'lab "A"'
    assert {frozenset(markers) for markers in named.segments.values()} == BOTH


def test_names_of_a_built_in_set_are_recognised():
    names = ["LTHI1", "LLEG1", "LTHI2", "LLEG2", "LTHI3", "LLEG3", "LGT", "LATT"]
    draft = draft_marker_set(names, [recording(6)])
    assert set(draft.perhaps) == {"thigh_left", "shank_left"}
    joined = draft_marker_set([*names], [recording(6)], rigid_m=1.0).perhaps
    assert joined == ("thigh_left, shank_left, which hardly moved relative to each other",)
