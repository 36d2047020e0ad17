"""Predicted errors, against fits of noisy torque."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.regressor import regressor, standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.excitation.driven import driven
from fitter.excitation.information import information, precision_of
from fitter.excitation.shapes import Points

ARM = load_arm("dd-arm")
BASE = structural_parameters(ARM)
NOISE = np.array([0.05, 0.01])


def motion_of(arm=ARM):
    shape = Points(6.75, 0.5, np.full(2, 1.0), smooth=False)
    genes = np.random.default_rng(1).uniform(-1, 1, shape.n_gene)
    return driven(arm, shape.trial(genes, np.arange(1350) * 0.005, np.zeros(2)), 0.005, np.zeros(2))


def test_errors_are_those_of_weighted_fits():
    motion = motion_of()
    rows = regressor(ARM, motion.q, motion.dq, motion.ddq)[..., list(BASE.independent)]
    moving = np.abs(motion.dq) > 0.02
    W = (rows / NOISE[:, None])[moving]
    true = BASE.combination @ standard_parameters(ARM)
    rng = np.random.default_rng(0)
    exact = W @ true
    fits = np.linalg.lstsq(W, exact[:, None] + rng.normal(size=(len(exact), 400)), rcond=None)[0]
    found = precision_of(information(ARM, BASE, motion, NOISE))
    assert found.std == pytest.approx(fits.std(axis=1), rel=0.15)
    assert found.std == pytest.approx(np.sqrt(np.diag(np.linalg.inv(W.T @ W))), rel=1e-6)
    assert found.condition_number == pytest.approx(np.linalg.cond(W / np.linalg.norm(W, axis=0)))


def test_what_does_not_move_is_not_told():
    found = precision_of(np.diag([4.0, 0.0]))
    assert found.std[0] == pytest.approx(0.5)
    assert found.std[1] == np.inf
    assert found.condition_number == np.inf
    assert np.all(precision_of(np.zeros((2, 2))).std == np.inf)


def test_two_alike_are_hardly_told():
    found = precision_of(np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    assert np.all(found.std[:2] > 1e4)
    assert found.std[2] == pytest.approx(1.0)
