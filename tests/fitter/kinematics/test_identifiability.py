"""Which geometric parameters the data can tell."""

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm, Joint
from fitter.kinematics.identifiability import identifiable, sought_by_default
from fitter.kinematics.tip_basis import GEOMETRY, geometry_names


def names_of(arm, mask):
    return {name for name, yes in zip(geometry_names(arm.n_joint), mask.ravel(), strict=True) if yes}


def test_as_the_paper_does_for_its_arm():
    """Section 6.1 fixes alpha1, d1 and d2; beta1 is 0 in all of its tables."""
    arm = load_arm("dd-arm")
    assert names_of(arm, ~sought_by_default(arm)) == {"alpha1", "d1", "beta1", "d2"}


def test_hayati():
    arm = Arm("x", tuple(Joint(alpha_rad=np.deg2rad(angle)) for angle in (0.0, 90.0, 5.0, 178.0)))
    sought = names_of(arm, sought_by_default(arm))
    assert {"d2", "beta3", "beta4"} <= sought
    assert not {"beta2", "d3", "d4"} & sought


def test_what_one_would_rather_learn_comes_first():
    rng = np.random.default_rng(0)
    a1, other = rng.normal(size=(2, 20))
    which = np.array([GEOMETRY.index("theta_offset"), GEOMETRY.index("a"), GEOMETRY.index("alpha")])
    is_determined = identifiable(np.array([a1 + other, a1, other]), which)
    assert is_determined.tolist() == [False, True, True]


def test_what_hardly_moves_the_tip_is_not_told():
    effects = np.diag([1.0, 1e-3])
    assert identifiable(effects, np.array([1, 6])).tolist() == [True, False]
    close = np.array([[1.0, 0.0], [1.0, 1e-3]])
    assert identifiable(close, np.array([1, 6])).tolist() == [True, False]
    assert identifiable(np.zeros((0, 4)), np.zeros(0, dtype=np.intp)).shape == (0,)
