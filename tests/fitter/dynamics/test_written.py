"""What an arm file gives back is what was printed, for every arm."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.base_parameters import base_parameters, with_base_values
from arm.model import Friction, Link
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.dynamics.written import differing, save_calibrated
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import Unusable
from tests.arm.conftest import draw_arm

FEW = settings(max_examples=12, deadline=None)


@FEW
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 2, 2, 3, 4]), st.booleans(), st.booleans())
def test_a_file_gives_back_every_base_parameter(seed, n_joint, with_masses, possible):
    """Arms with and without masses in their file, numbers that masses can have and numbers that none can."""
    rng = np.random.default_rng(seed)
    arm = draw_arm(rng, n_joint)
    base = base_parameters(arm)
    values = base.combination @ standard_parameters(arm)
    values = values if possible else values * rng.choice([-1.0, 1.0], len(values))
    if not with_masses:
        arm = replace(arm, joints=tuple(replace(j, link=Link(), friction=Friction()) for j in arm.joints))
    back = parse_arm(format_arm(with_base_values(arm, base, values)), "back")
    found = base.combination @ standard_parameters(back)
    np.testing.assert_allclose(found, values, rtol=0, atol=1e-9 * np.abs(values).max())


def printed(arm, base):
    values = base.combination @ standard_parameters(arm)
    return {name: FittedParameter(v, np.nan, "x", True) for name, v in zip(base.names, values, strict=True)}


def test_an_arm_is_written_if_it_has_what_is_printed(tmp_path):
    arm = load_arm("dd-arm")
    base = structural_parameters(arm)
    save_calibrated(arm, base, printed(arm, base), tmp_path / "arm.toml")
    assert not differing(load_arm(tmp_path / "arm.toml"), base, printed(arm, base))


def test_an_arm_that_lost_a_first_moment_is_not_written(tmp_path):
    arm = load_arm("dd-arm")
    base = structural_parameters(arm)
    link = arm.joints[1].link
    weightless = replace(arm.joints[1], link=Link(0.0, link.com_m, link.inertia_kg_m2))
    lost = replace(arm, joints=(arm.joints[0], weightless))
    with pytest.raises(Unusable, match=r"m2\*sx2"):
        save_calibrated(lost, base, printed(arm, base), tmp_path / "arm.toml")
    assert not (tmp_path / "arm.toml").exists()
