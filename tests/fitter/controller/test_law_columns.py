"""The columns of eq. (4) and of a control law."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.control import control_torque
from arm.model import Control
from arm.newton_euler import inverse_dynamics
from arm.regressor import standard_parameters
from fitter.controller.law_columns import law_columns, law_rows

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
LAWS = (
    Control("p", (3.0, 5.0)),
    Control("pd", (3.0, 5.0), (-1.0, -2.0)),
    Control("pda", (3.0, 5.0), (-1.0, -2.0), (-0.1, -0.2)),
)


@pytest.mark.parametrize("control", LAWS)
def test_rows_times_values_are_inverse_dynamics_less_the_law_s_torque(control):
    q, dq, ddq, ref = np.random.default_rng(0).normal(size=(4, 20, 2))
    columns = law_columns(ARM, BASE).narrowed(control.law)
    values = columns.start(BASE.combination @ standard_parameters(ARM), control)
    rows = law_rows(ARM, BASE, q, dq, ddq, ref - q)[..., : len(values)]
    missing = inverse_dynamics(ARM, q, dq, ddq) - control_torque(control, q, dq, ddq, ref)
    assert rows @ values == pytest.approx(missing, abs=1e-9)


@pytest.mark.parametrize("control", LAWS)
def test_gains_come_back(control):
    columns = law_columns(ARM, BASE, control.law)
    values = columns.start(np.zeros(columns.n_base), control)
    assert columns.control(values) == control
    assert columns.law_table(values)[0].tolist() == [3.0, 5.0]
    assert [columns.names[k] for k in columns.kp] == ["kp1", "kp2"]
    assert dict(zip(columns.names, columns.units, strict=True))["kp2"] == "N m/rad"
