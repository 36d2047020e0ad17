"""The parameters of an arm with effects."""

from dataclasses import replace

import numpy as np

from arm.arm_file import load_arm
from arm.model import Effect
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.dynamics.shooting_effects import numbers_of

ARM = replace(
    load_arm("dd-arm"),
    effects=(
        Effect("air_drag", {"drag_N_m_s2": 0.01}, joints=(2,)),
        Effect("gravity_tilt", {"gx_m_s2": -1.0, "gy_m_s2": 0.5}),
    ),
)
BASE = structural_parameters(ARM)


def test_base_parameters_come_first_then_those_of_the_effects():
    numbers = numbers_of(ARM, BASE)
    assert np.allclose(numbers.values, [*BASE.combination @ standard_parameters(ARM), 0.01, -1.0, 0.5])
    assert numbers.place(1, "gy_m_s2") == len(BASE.names) + 2
    assert numbers.place(0, "gy_m_s2") is None


def test_other_values_are_those_of_the_arm_s_effects():
    numbers = numbers_of(ARM, BASE)
    values = numbers.values
    values[-2:] = 0.2, 0.3
    moved = numbers.with_effects(values)
    assert moved.effects[1].parameters == {"gx_m_s2": 0.2, "gy_m_s2": 0.3}
    assert moved.joints == ARM.joints


def test_a_drag_is_never_negative_and_base_parameters_are_unbounded():
    low, high = numbers_of(ARM, BASE).bounds
    assert np.isneginf(low[: len(BASE.names)]).all() and np.isposinf(high[: len(BASE.names)]).all()
    assert low[len(BASE.names)] == 0.0
