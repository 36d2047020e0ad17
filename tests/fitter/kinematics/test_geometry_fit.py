"""Geometry, found again."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from arm.model import Arm, Joint
from fitter.data.trial import Trial
from fitter.kinematics.geometry_fit import fit_kinematics
from fitter.kinematics.kinematics_fit import document
from fitter.kinematics.tip_basis import geometry_of, with_geometry
from fitter.kinematics.tip_error import tip_score
from limbcal.command import to_json
from limbcal.errors import ConfigError, DataError, NotConverged, NotIdentifiable

ARM = load_arm("dd-arm")
PRIOR = with_geometry(ARM, np.array([[0.0, 0.4, 0.0, 0.0, 0.1], [0.0, 0.5, 0.0, 0.0, -0.1]]))


def random_poses(arm: Arm, n: int, seed: int, reach: float = 1.2) -> Trial:
    rng = np.random.default_rng(seed)
    slides = np.array([joint.type == "prismatic" for joint in arm.joints])
    q = rng.uniform(-reach, reach, (n, arm.n_joint)) * np.where(slides, 0.2, 1.0)
    return Trial("poses", np.arange(n) * 0.001, 0.001, q, np.ones_like(q), 0.0 * q, tip=tip_position(arm, q))


def test_the_paper_s_arm(bench_trials):
    fit = fit_kinematics(PRIOR, bench_trials[:4], seed=1)
    assert np.allclose(geometry_of(fit.arm), geometry_of(ARM), atol=1e-6)
    assert {name for name, p in fit.parameters.items() if not p.identifiable} == {"alpha1", "beta1", "d1", "d2"}
    assert tip_score(fit.arm, bench_trials[4:]).max_mm < 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_a_spatial_arm_with_a_joint_that_slides(seed):
    rng = np.random.default_rng(seed)
    kinds = ("revolute", "prismatic", "revolute")
    angles = rng.uniform(0.8, 1.4, 3) * rng.choice([-1.0, 1.0], 3)
    joints = (
        Joint(kind, alpha_rad=angle, a_m=rng.uniform(0.1, 0.4), d_m=0.1, theta_offset_rad=rng.normal() / 5)
        for kind, angle in zip(kinds, angles, strict=True)
    )
    prior = Arm("spatial", tuple(joints))
    learn = random_poses(prior, 500, seed)
    is_determined = np.array([p.identifiable for p in fit_kinematics(prior, [learn]).parameters.values()])
    assert 7 <= np.count_nonzero(is_determined) <= 11
    moved = np.where(is_determined, rng.uniform(-0.1, 0.1, 15), 0.0).reshape(3, 5)
    true = with_geometry(prior, geometry_of(prior) + moved)
    fit = fit_kinematics(prior, [random_poses(true, 500, seed)], seed=seed)
    assert np.allclose(geometry_of(fit.arm), geometry_of(true), atol=1e-6)
    assert tip_score(fit.arm, [random_poses(true, 100, seed + 9)]).max_mm < 1e-3


def test_a_gauge_that_is_chosen_otherwise_moves_the_tip_alike():
    """Where the true arm differs in what cannot be identified, the fit still reaches where it does."""
    true = Arm("true", (Joint(a_m=0.3, d_m=0.4), Joint(a_m=0.2, d_m=-0.3)))
    prior = Arm("prior", (Joint(a_m=0.2), Joint(a_m=0.3)))
    fit = fit_kinematics(prior, [random_poses(true, 300, 0)])
    assert fit.parameters["d1"].value == fit.parameters["d2"].value == 0.0
    assert np.isnan(fit.parameters["d2"].std)
    assert tip_score(fit.arm, [random_poses(true, 300, 1)]).max_mm < 1e-3


def test_standard_errors_are_those_of_the_noise():
    answers, errors = [], []
    for seed in range(25):
        poses = random_poses(ARM, 1500, seed)
        noise = 0.005 * np.random.default_rng(100 + seed).normal(size=(1500, 3))
        fit = fit_kinematics(PRIOR, [replace(poses, tip=poses.tip + noise)], about="mean", generations=150)
        answers.append([p.value for p in fit.parameters.values() if p.identifiable])
        errors.append([p.std for p in fit.parameters.values() if p.identifiable])
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / np.std(answers, axis=0)
    assert np.all((ratio > 0.6) & (ratio < 1.6))
    truth = [value for k, value in enumerate(geometry_of(ARM).ravel()) if k in (1, 4, 5, 6, 8, 9)]
    assert np.all(np.abs(np.mean(answers, axis=0) - truth) < 4.0 * np.mean(errors, axis=0) / 5.0)


def test_same_seed_same_answer(bench_trials):
    fits = [fit_kinematics(PRIOR, bench_trials[:1], seed=4, clock=lambda: 0.0) for _ in range(2)]
    first, second = (to_json(document(fit, tip_score(fit.arm, bench_trials))) for fit in fits)
    assert first == second


def test_says_why_there_is_no_answer(bench_trials):
    with pytest.raises(DataError, match="no learning trial"):
        fit_kinematics(PRIOR, [])
    with pytest.raises(DataError, match="has no tip"):
        fit_kinematics(PRIOR, [replace(bench_trials[0], tip=None)])
    still = replace(bench_trials[0], q=np.zeros_like(bench_trials[0].q))
    with pytest.raises(NotIdentifiable, match="no geometric parameter"):
        fit_kinematics(PRIOR, [still])
    with pytest.raises(NotConverged, match="more generations"):
        fit_kinematics(PRIOR, bench_trials[:1], generations=5)


def test_a_tree_has_no_geometry_that_a_tip_tells():
    tree = replace(ARM, joints=(ARM.joints[0], replace(ARM.joints[1], parent=0)))
    with pytest.raises(ConfigError, match="'dd-arm' is a tree.* of a serial chain only"):
        fit_kinematics(tree, [random_poses(tree, 20, 0)])
