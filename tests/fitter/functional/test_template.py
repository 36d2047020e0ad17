"""Shapes of segments from frames with gaps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from fitter.functional.template import learn_template
from limbcal.errors import DataError
from tests.fitter.functional.test_rigid_fit import SHAPE, moved

NAMES = ("A", "B", "C", "D", "E")


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_distances_are_those_of_the_shape_whatever_is_missing(seed):
    rng = np.random.default_rng(seed)
    _, _, x = moved(rng, 300)
    x[rng.uniform(size=x.shape[:2]) < 0.4] = np.nan
    template = learn_template(NAMES, [x[:100], x[100:]])
    assert np.allclose(pdist(template.points_m), pdist(SHAPE), atol=1e-4)
    assert template.missing == ()
    assert np.all(template.rms_m < 1e-4)


def test_the_order_of_markers_changes_nothing():
    _, _, x = moved(np.random.default_rng(3), 200, noise_m=0.003)
    order = [3, 0, 4, 2, 1]
    one, other = learn_template(NAMES, [x]), learn_template([NAMES[i] for i in order], [x[:, order]])
    assert np.allclose(pdist(one.points_m[order]), pdist(other.points_m), atol=1e-5)


def test_a_rigid_motion_of_the_recording_changes_nothing():
    rng = np.random.default_rng(4)
    _, _, x = moved(rng, 200, noise_m=0.003)
    R, p, _ = moved(rng, 1)
    one, other = learn_template(NAMES, [x]), learn_template(NAMES, [x @ R[0].T + p[0]])
    assert np.allclose(pdist(one.points_m), pdist(other.points_m), atol=1e-6)
    assert np.allclose(one.rms_m, other.rms_m, atol=1e-6)


def test_markers_that_are_never_together_are_placed_by_way_of_others():
    _, _, x = moved(np.random.default_rng(5), 200)
    x[:100, 4] = np.nan
    x[100:, 0] = np.nan
    assert np.allclose(pdist(learn_template(NAMES, [x]).points_m), pdist(SHAPE), atol=1e-5)


def test_the_noise_of_each_marker_is_told():
    rng = np.random.default_rng(6)
    _, _, x = moved(rng, 1000)
    x[:, 2] += 0.01 * rng.normal(size=(1000, 3))
    template = learn_template(NAMES, [x])
    assert np.argmax(template.rms_m) == 2


def test_a_marker_that_is_never_seen_is_missing():
    _, _, x = moved(np.random.default_rng(7), 50)
    x[:, 1] = np.nan
    assert learn_template(NAMES, [x]).missing == ("B",)


def test_two_markers_in_a_frame_are_too_few():
    _, _, x = moved(np.random.default_rng(8), 50)
    x[:, 2:] = np.nan
    with pytest.raises(DataError, match="A, B, C, D, E: never three of them in one frame"):
        learn_template(NAMES, [x])


def test_markers_in_a_line_are_refused():
    x = np.tile(np.linspace(0.0, 0.2, 4)[None, :, None] * [1.0, 0.0, 0.0], (30, 1, 1))
    with pytest.raises(DataError, match="straight line"):
        learn_template(NAMES[:4], [x])


def test_a_marker_that_leaps_now_and_then_does_not_bend_the_shape():
    _, _, x = moved(np.random.default_rng(9), 400, noise_m=0.001)
    calm = learn_template(NAMES, [x])
    x[50:100, 3] += 0.4
    assert np.allclose(pdist(learn_template(NAMES, [x]).points_m), pdist(calm.points_m), atol=5e-4)


def test_a_marker_that_is_seen_once_in_a_long_recording_is_placed():
    _, _, x = moved(np.random.default_rng(10), 9000)
    x[:, 4] = np.nan
    x[4321, 4] = moved(np.random.default_rng(10), 9000)[2][4321, 4]
    template = learn_template(NAMES, [x])
    assert template.missing == ()
    assert np.allclose(pdist(template.points_m), pdist(SHAPE), atol=1e-4)
