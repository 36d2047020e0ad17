"""Numbers of an arm that simulations are shot with."""

import math
from dataclasses import replace

import numpy as np

from arm.model import Effect
from fitter.diagnosis.simulated_motion.numbers import numbers_of
from fitter.dynamics.structure import structural_parameters


def test_base_parameters_come_first_and_lists_and_infinities_are_no_numbers(true_arm):
    payload = Effect("payload", {"mass_kg": 0.1, "trials": [2]})
    limit = Effect("torque_saturation", {"limit_N_m": math.inf}, joints=(1,))
    base = structural_parameters(true_arm)
    numbers = numbers_of(replace(true_arm, effects=(*true_arm.effects, payload, limit)), base)
    assert numbers.places == ((0, "inertia_kg_m2"), (1, "mass_kg"))
    assert numbers.place(1, "mass_kg") == len(base.names) + 1
    assert numbers.place(2, "limit_N_m") is None
    low, high = numbers.bounds
    assert low[-2] == 0.0 and math.isinf(high[0])
    np.testing.assert_allclose(numbers.values[-2:], [0.004, 0.1])


def test_an_arm_with_other_effects_numbers_keeps_its_links(true_arm):
    numbers = numbers_of(true_arm, structural_parameters(true_arm))
    arm = numbers.with_effects(1.5 * numbers.values)
    assert arm.effects[0].parameters["inertia_kg_m2"] == 1.5 * 0.004
    assert arm.joints == true_arm.joints
