"""The picture of the frames: drawn by the very factors that the arm's kinematics have."""

from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import link_transforms
from arm.model import Joint

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def figure():
    spec = spec_from_file_location("frames_figure", DOCS / "frames_figure.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_factors_are_those_of_eq_1(figure):
    alpha, beta, d, theta, a = -0.5, 0.4, 0.3, 0.8, 1.2
    joint = Joint(alpha_rad=alpha, a_m=a, d_m=d, beta_rad=beta)
    arm = replace(load_arm("dd-arm"), joints=(joint,), sensors=(), tip=None)
    product = figure.rotation("y", beta) @ figure.rotation("x", alpha) @ figure.translation(0.0, 0.0, d)
    product = product @ figure.rotation("z", theta) @ figure.translation(a, 0.0, 0.0)
    assert np.allclose(product, link_transforms(arm, np.array([[theta]]))[0, 0])


def test_it_is_drawn_and_lies_where_the_readme_looks_for_it(figure):
    drawn = figure.draw()
    words = " ".join(text.get_text() for axes in drawn.axes for text in axes.texts)
    for symbol in (r"\alpha_i", r"\beta_i", r"\theta_i", "a_i", "d_i", "position_m"):
        assert symbol in words
    assert (DOCS / "frames.png").is_file()
