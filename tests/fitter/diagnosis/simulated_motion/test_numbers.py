"""Numbers of an arm by their names."""

import math
from dataclasses import replace

import pytest

from arm.model import Effect
from arm.regressor import standard_parameters
from fitter.diagnosis.simulated_motion.numbers import numbers_of
from fitter.dynamics.structure import structural_parameters
from limbcal.errors import ConfigError


def test_base_parameters_and_effects_are_called_by_name(true_arm):
    payload = Effect("payload", {"mass_kg": 0.1, "trials": [2]})
    limit = Effect("torque_saturation", {"limit_N_m": math.inf}, joints=(1,))
    base = structural_parameters(true_arm)
    numbers = numbers_of(replace(true_arm, effects=(*true_arm.effects, payload, limit)), base)
    assert numbers.names == (*base.names, "effect[0].inertia_kg_m2", "effect[1].mass_kg")
    assert numbers.units[-2:] == ("kg m^2", "kg")
    low, high = numbers.bounds
    assert low[-2] == 0.0 and math.isinf(high[0])
    with pytest.raises(ConfigError, match=r"nothing is called effect\[7\]"):
        numbers.sought(["I2", "effect[7].mass_kg"])


def test_an_arm_with_other_numbers_has_them(true_arm):
    base = structural_parameters(true_arm)
    numbers = numbers_of(true_arm, base)
    values = 1.1 * numbers.values
    arm = numbers.with_values(values)
    assert base.combination @ standard_parameters(arm) == pytest.approx(values[:-1])
    assert arm.effects[0].parameters["inertia_kg_m2"] == pytest.approx(values[-1])
