"""Words for what a fit of arm and law rests on."""

import numpy as np

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from fitter.controller.law_ambiguity import Ambiguity
from fitter.controller.law_columns import law_columns
from fitter.controller.law_fit import LawFit
from fitter.controller.law_sentences import fixed_by, only_together

COLUMNS = law_columns(load_arm("dd-arm"), base_parameters(load_arm("dd-arm")), "pd")


def test_the_number_that_fixes_the_factor_is_named():
    assert "given, kp1 = 9.5 fixes" in fixed_by({"kp1": 9.5}, {}, False)
    assert "kp1 = 9.5, I2 = 0.06 fix the" in fixed_by({"kp1": 9.5, "I2": 0.06}, {}, False)
    assert "kp1 = 2 of the arm file is taken for the truth" in fixed_by({}, {"kp1": 2.0}, False)
    assert fixed_by({}, {}, True).startswith("the measured torque")


def test_viscous_friction_and_kv_are_told_as_their_difference():
    n, D1, kv1 = len(COLUMNS.names), COLUMNS.names.index("D1"), COLUMNS.names.index("kv1")
    trade = np.zeros((1, n))
    trade[0, [D1, kv1]] = 1.0
    values = np.zeros(n)
    values[[D1, kv1]] = 0.5, -9.0
    fit = LawFit(
        COLUMNS,
        values,
        np.setdiff1d(np.arange(n), [D1]),
        np.eye(n - 1),
        Ambiguity(np.zeros((0, n)), (), trade, (D1,)),
        np.zeros(2),
        True,
    )
    (sentence,) = only_together(fit)
    assert sentence.startswith("kv1 - D1 = -9.5 ± 2.0 ")
    assert sentence.endswith("D1 keeps the arm file's value")
