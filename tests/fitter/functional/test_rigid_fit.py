"""Poses of rigid bodies from points with gaps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fitter.functional.rigid_fit import LEAST_WIDTH_M, fit_poses

SHAPE = np.array(
    [[0.1, 0.0, 0.0], [0.0, 0.08, 0.0], [-0.05, -0.03, 0.06], [0.02, -0.09, -0.04], [-0.06, 0.05, 0.02]]
)
seeds = st.integers(0, 2**32 - 1)


def moved(rng: np.random.Generator, n: int, noise_m: float = 0.0):
    R, p = Rotation.random(n, random_state=rng).as_matrix(), rng.normal(size=(n, 3))
    return R, p, np.einsum("nij,mj->nmi", R, SHAPE) + p[:, None] + noise_m * rng.normal(size=(n, len(SHAPE), 3))


@given(seeds)
def test_points_without_noise_give_their_pose_whatever_is_missing(seed):
    rng = np.random.default_rng(seed)
    R, p, x = moved(rng, 20)
    x[rng.uniform(size=x.shape[:2]) < 0.4] = np.nan
    poses = fit_poses(SHAPE, x)
    enough = np.isfinite(x[..., 0]).sum(axis=1) >= 3
    assert np.array_equal(poses.valid, enough)  # any three of this shape are off a line
    assert np.allclose(poses.R[enough], R[enough], atol=1e-9)
    assert np.allclose(poses.p[enough], p[enough], atol=1e-9)
    assert np.all(poses.rms_m[enough] < 1e-9)


@given(seeds)
def test_it_is_the_rotation_that_scipy_finds(seed):
    rng = np.random.default_rng(seed)
    _, _, x = moved(rng, 3, noise_m=0.02)
    x[0, 1] = np.nan
    poses = fit_poses(SHAPE, x)
    for i in range(3):
        seen = np.isfinite(x[i, :, 0])
        local, world = SHAPE[seen] - SHAPE[seen].mean(axis=0), x[i, seen] - x[i, seen].mean(axis=0)
        expected = Rotation.align_vectors(world, local)[0].as_matrix()
        assert np.allclose(poses.R[i], expected, atol=1e-7)
        assert np.isclose(np.linalg.det(poses.R[i]), 1.0)


def test_a_flat_segment_is_not_mirrored():
    flat = SHAPE * [1.0, 1.0, 0.0]
    R = Rotation.from_rotvec([3.0, 0.2, 0.1]).as_matrix()
    poses = fit_poses(flat, (flat @ R.T)[None])
    assert np.allclose(poses.R[0], R)


def test_points_near_a_line_have_no_pose():
    line = np.array([[0.0, 0.0, 0.0], [0.1, 0.5 * LEAST_WIDTH_M, 0.0], [0.2, 0.0, 0.0]])
    assert not fit_poses(line, line[None]).valid.any()


def test_a_point_whose_place_is_unknown_counts_as_unseen():
    unknown = SHAPE.copy()
    unknown[0] = np.nan
    poses = fit_poses(unknown, SHAPE[None])
    assert poses.valid[0]
    assert np.isnan(poses.marker_rms_m[0])
    assert np.allclose(poses.marker_rms_m[1:], 0.0, atol=1e-12)


def test_points_go_to_the_world_and_back():
    rng = np.random.default_rng(1)
    _, _, x = moved(rng, 5)
    poses = fit_poses(SHAPE, x)
    point = np.array([0.1, -0.2, 0.3])
    assert np.allclose(poses.to_segment(poses.to_world(point)), point)


@pytest.mark.parametrize("seen", [0, 1, 2])
def test_too_few_points_have_no_pose_and_make_no_noise(seen):
    x = SHAPE[None].copy()
    x[0, seen:] = np.nan
    poses = fit_poses(SHAPE, x)
    assert not poses.valid.any()
    assert np.isnan(poses.rms_m).all()
