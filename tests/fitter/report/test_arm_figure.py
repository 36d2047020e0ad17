"""A picture of any arm."""

import io
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import image

from arm.arm_file import load_arm, preset_names
from arm.model import Joint
from fitter.report import arm_figure as module
from fitter.report.arm_figure import arm_figure
from fitter.search.fitted_parameter import FittedParameter


def pixels(png):
    return image.imread(io.BytesIO(png), format="png")


@pytest.mark.parametrize("name", preset_names())
def test_built_in_arms_are_drawn_the_same_each_time(name):
    arm = load_arm(name)
    drawn = arm_figure(arm)
    assert drawn == arm_figure(arm)
    assert np.count_nonzero(pixels(drawn)[..., :3].min(axis=2) < 0.9) > 2000


@pytest.mark.parametrize("n_joint", [1, 3, 9])
def test_any_number_of_joints_and_no_length_at_all(n_joint):
    joint = Joint(a_m=0.2, d_m=0.1, alpha_rad=0.4)
    arm = replace(load_arm("dd-arm"), joints=(joint,) * n_joint, sensors=(), tip=None)
    assert pixels(arm_figure(arm)).size
    points = replace(arm, joints=(Joint(type="prismatic"),) * n_joint)
    assert pixels(arm_figure(points)).size


def test_learnt_lengths_are_listed_with_their_intervals(monkeypatch):
    lines = module._listed(
        load_arm("dd-arm"),
        {
            "a1": FittedParameter(0.25012, 0.0002, "m", True),
            "d1": FittedParameter(0.0, np.nan, "m", False),
            "a2": FittedParameter(0.3, np.nan, "m", False),
        },
    )
    assert lines == ["a1 = 0.25012 ± 0.00039 m", "a2 = 0.3000 m (arm file)"]


def test_a_flat_arm_is_seen_from_where_it_is_flat():
    for normal in np.eye(3):
        in_plane = np.eye(3)[normal == 0.0]
        view = module._view(np.vstack([np.zeros(3), in_plane, in_plane.sum(axis=0)]))
        assert np.allclose(view @ view.T, np.eye(2)) and np.allclose(view @ normal, 0.0)
