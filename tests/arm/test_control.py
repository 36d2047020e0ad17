"""Laws (5), (6) and (7)."""

import numpy as np
import pytest

from arm.control import control_torque, gains
from arm.model import Control
from limbcal.errors import ConfigError

Q, DQ, DDQ, REF = np.random.default_rng(0).normal(size=(4, 3, 2))
KP, KV, KA = (9.5, 8.5), (-9.5, -7.5), (-1.5, -3.5)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("pd", KP * (REF - Q) + KV * DQ),
        ("pda", KP * (REF - Q) + KV * DQ + KA * DDQ),
        ("p", KP * (REF - Q)),
    ],
)
def test_a_law_uses_its_gains_and_no_others(law, expected):
    found = control_torque(Control(law, KP, KV, KA), Q, DQ, DDQ, REF)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


def test_the_sign_of_the_velocity_gain_is_the_papers():
    """Law (5) adds kv dq, and -9.5 damps."""
    torque = control_torque(Control("pd", (0.0,), (-9.5,)), *np.array([[[0.0]], [[1.0]], [[0.0]], [[0.0]]]))
    assert torque[0, 0] == -9.5


def test_gains_that_are_missing_or_measured_are_named():
    with pytest.raises(ConfigError, match=r"control.kv has 1 numbers, expected one a joint \(2\)"):
        gains(Control("pd", (1.0, 2.0), (1.0,)), 2)
    with pytest.raises(ConfigError, match="control.law is 'measured', which gives no torque"):
        control_torque(Control(), Q, DQ, DDQ, REF)
