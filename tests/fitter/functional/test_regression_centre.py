"""Centres from landmarks."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fitter.functional.regression_centre import regression_centres

#: A pelvis 240 mm wide and 160 mm deep in ISB axes, forward, up, right; shoulders 400 mm apart on an upright
#: trunk.
STANDING = {
    "asis_right": [0.0, 0.0, 0.12],
    "asis_left": [0.0, 0.0, -0.12],
    "psis_right": [-0.16, 0.0, 0.05],
    "psis_left": [-0.16, 0.0, -0.05],
    "acromion_right": [-0.05, 0.5, 0.2],
    "acromion_left": [-0.05, 0.5, -0.2],
    "suprasternal_notch": [0.05, 0.45, 0.0],
    "c7": [-0.05, 0.55, 0.0],
    "xiphoid": [0.08, 0.3, 0.0],
    "t10": [-0.08, 0.3, 0.0],
    "lateral_femoral_epicondyle_right": [0.0, -0.5, 0.14],
    "medial_femoral_epicondyle_right": [0.0, -0.52, 0.04],
}


def landmarks(**moved):
    return {name: np.array([at], dtype=np.float64) for name, at in (STANDING | moved).items()}


def found(at):
    return {(centre.joint, centre.method): centre for centre in regression_centres(at)}


@pytest.mark.parametrize(
    ("joint", "method", "expected_mm"),
    [
        # by hand from the equations as printed: -0.24 × 160 - 9.9; -0.30 × 240 - 10.9; 0.33 × 240 + 7.3
        ("hip_right", "harrington", [-48.3, -82.9, 86.5]),
        ("hip_left", "harrington", [-48.3, -82.9, -86.5]),
        # -0.19, -0.30 and 0.36 of 240
        ("hip_right", "bell", [-45.6, -72.0, 86.4]),
        ("hip_left", "bell", [-45.6, -72.0, -86.4]),
        ("knee_right", "middle", [0.0, -510.0, 90.0]),
    ],
)
def test_digits_are_those_of_the_papers(joint, method, expected_mm):
    assert found(landmarks())[joint, method].position_m[0] == pytest.approx(np.array(expected_mm) / 1e3, abs=1e-9)


def test_only_what_the_landmarks_allow():
    at = landmarks()
    del at["psis_left"]
    assert set(found(at)) == {("knee_right", "middle")}


@given(st.integers(0, 2**32 - 1))
def test_centres_go_with_the_body(seed):
    rng = np.random.default_rng(seed)
    R, p = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    still = found(landmarks())
    for key, centre in found({name: at @ R.T + p for name, at in landmarks().items()}).items():
        assert np.allclose(centre.position_m, still[key].position_m @ R.T + p, atol=1e-9)


def test_a_missing_landmark_leaves_its_frame_open():
    at = {name: np.repeat(x, 3, axis=0) for name, x in landmarks().items()}
    at["asis_left"][1] = np.nan
    hip = found(at)["hip_right", "harrington"].position_m
    assert list(np.isfinite(hip).all(axis=1)) == [True, False, True]
