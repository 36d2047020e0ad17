"""Parameters that are known beforehand."""

import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from fitter.controller.fixed_parameters import anchors_of, fixed_parameters
from fitter.controller.law_columns import law_columns
from fitter.controller.law_equations import law_equations
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = law_columns(ARM, BASE, "pd")


def test_gains_that_are_not_free_are_the_arm_file_s():
    assert fixed_parameters(ARM, COLUMNS, {"I2": 0.1}, {"kv1", "kv2"}) == {"I2": 0.1, "kp1": 9.5, "kp2": 9.5}
    assert fixed_parameters(ARM, COLUMNS, {"I2": 0.1}, None) == {"I2": 0.1}


@pytest.mark.parametrize(
    ("fixed", "free", "said"),
    [({"x": 1.0}, None, "nothing is called x"), ({"kp1": 1.0}, {"kp1"}, "both"), ({"kp2": 0.0}, None, "to 0")],
)
def test_contradictions_are_refused(fixed, free, said):
    with pytest.raises(ConfigError, match=said):
        fixed_parameters(ARM, COLUMNS, fixed, free)


def test_the_arm_s_one_common_factor_rests_on_its_first_kp(bench_trials):
    assert anchors_of(ARM, COLUMNS, [law_equations(ARM, BASE, bench_trials[0])]) == (("kp1", 9.5),)
