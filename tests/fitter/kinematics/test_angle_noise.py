"""Noise known, seen, or estimated; and whether it does harm where there is none."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.data.trial import Trial
from fitter.kinematics.angle_noise import resolved_noise
from fitter.kinematics.geometry_fit import fit_kinematics
from fitter.kinematics.kinematics_fit import document
from fitter.kinematics.tip_basis import geometry_of, with_geometry
from fitter.kinematics.tip_error import TipScore
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")
PRIOR = with_geometry(ARM, np.array([[0.0, 0.4, 0.0, 0.0, 0.1], [0.0, 0.5, 0.0, 0.0, -0.1]]))


def poses(n, deg, tip_std, seed, reach):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-reach, reach, (n, 2))
    tip = tip_position(ARM, q) + tip_std * rng.normal(size=(n, 3))
    noisy = q + np.deg2rad(deg) * rng.normal(size=q.shape)
    return Trial("p", np.arange(n) * 0.001, 0.001, noisy, np.gradient(noisy, 0.001, axis=0), 0 * q, tip=tip)


def off_by_std(fit):
    lengths = np.array([fit.parameters[name].value for name in ("a1", "a2")])
    return (lengths - [0.25, 0.3]) / [fit.parameters[name].std for name in ("a1", "a2")]


@pytest.mark.parametrize("reach", [np.pi, 1.2])
def test_table_1_without_its_attenuation(reach):
    trial = poses(12_000, 15.0, 0.03, 0, reach)
    plain = fit_kinematics(PRIOR, [trial], angle_noise=None)
    assert geometry_of(plain.arm)[1, 1] < 0.29  # what the paper has
    fit = fit_kinematics(PRIOR, [trial])
    assert (fit.angle_noise_source, fit.about) == ("moments", "mean")
    assert np.all(np.abs(off_by_std(fit)) < 4.0)
    assert np.allclose(geometry_of(fit.arm)[:, 1], [0.25, 0.3], atol=8e-3)
    assert np.allclose(np.rad2deg(fit.angle_noise_rad), 15.0, atol=1.0)


@pytest.mark.parametrize("n", [800, 6000])  # from corrected sums alone, and from moments
def test_noise_that_is_known(n):
    fit = fit_kinematics(PRIOR, [poses(n, 15.0, 0.01, 1, 2.5)], angle_noise=[np.deg2rad(15.0)] * 2)
    assert fit.angle_noise_source == "known"
    assert np.allclose(np.rad2deg(fit.angle_noise_rad), 15.0)
    assert np.all(np.abs(off_by_std(fit)) < 4.0)


@pytest.mark.parametrize("tip_std", [0.0, 0.01])
def test_where_there_is_none_the_answer_is_the_plain_one(tip_std):
    trial = poses(8000, 0.0, tip_std, 2, 1.2)
    plain, fit = (fit_kinematics(PRIOR, [trial], about="mean", angle_noise=noise) for noise in (None, "auto"))
    std = np.array([p.std for p in plain.parameters.values() if p.identifiable])
    change = geometry_of(fit.arm) - geometry_of(plain.arm)
    is_determined = np.array([p.identifiable for p in plain.parameters.values()])
    assert np.all(np.abs(change.ravel()[is_determined]) <= 1.5 * std + 1e-9)


def test_a_smooth_motion_shows_its_noise():
    rng = np.random.default_rng(3)
    t = np.arange(20_000) * 0.001
    q = np.column_stack([np.sin(2.1 * t) + 0.5 * np.sin(3.3 * t), 1.2 * np.sin(2.9 * t + 1.0)])
    noisy = q + np.deg2rad(12.0) * rng.normal(size=q.shape)
    tip = tip_position(ARM, q) + 0.01 * rng.normal(size=(len(q), 3))
    fit = fit_kinematics(PRIOR, [Trial("m", t, 0.001, noisy, np.gradient(noisy, 0.001, axis=0), 0 * q, tip=tip)])
    assert fit.angle_noise_source == "spectrum"
    assert np.allclose(np.rad2deg(fit.angle_noise_rad), 12.0, atol=0.4)
    assert np.all(np.abs(off_by_std(fit)) < 4.0)


def test_what_is_given_is_checked():
    assert resolved_noise(ARM, [], [0.1, 0.0]).source == "known"
    assert resolved_noise(ARM, [], None).undone is None
    for wrong in ([0.1], [0.1, -0.1], [0.1, np.nan]):
        with pytest.raises(ConfigError, match="expected 2 numbers"):
            resolved_noise(ARM, [], wrong)


def test_the_document_says_where_it_comes_from():
    fit = fit_kinematics(PRIOR, [poses(300, 0.0, 0.01, 4, 1.2)])  # too few to estimate anything
    is_determined = document(fit, TipScore(0.0, 0.0))
    assert is_determined["angle_noise_deg"] == [None, None]
    assert is_determined["angle_noise_source"] is None
    fit = fit_kinematics(PRIOR, [poses(300, 5.0, 0.01, 4, 1.2)], angle_noise=np.deg2rad([5.0, 5.0]))
    assert document(fit, TipScore(0.0, 0.0))["angle_noise_deg"] == pytest.approx([5.0, 5.0])
