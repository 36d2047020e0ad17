"""Skin that slides over the bone in proportion to a joint's position."""

import numpy as np

from arm.effects.soft_tissue import EFFECT, SLOPES, slid
from arm.model import Effect

NUMBERS = {"x_m_rad": 0.01, "y_m_rad": 0.02, "z_m_rad": -0.03, "rest_rad": 0.5, "joint": 2}


def test_it_slides_from_rest_in_proportion_to_its_joint():
    q = np.array([[9.0, 0.5, 7.0], [9.0, 1.5, 7.0], [9.0, -1.5, 7.0]])
    found = slid(Effect("soft_tissue", NUMBERS, markers=("B",)), q)
    np.testing.assert_allclose(found, [[0.0, 0.0, 0.0], [0.01, 0.02, -0.03], [-0.02, -0.04, 0.06]], atol=1e-15)


def test_with_its_neutral_numbers_it_stays():
    neutral = {p.name: p.neutral for p in EFFECT.parameters if p.neutral is not None}
    assert set(neutral) == set(SLOPES)
    assert not slid(Effect("soft_tissue", NUMBERS | neutral, markers=("B",)), np.ones((3, 2))).any()


def test_what_it_may_be(ranges, accepts):
    for axis in SLOPES:
        ranges("soft_tissue", axis, -1.0, 1.0, **{name: x for name, x in NUMBERS.items() if name != axis})
    for name, least, most in (("rest_rad", -1e3, 1e3), ("joint", 1.0, 1e6)):
        ranges("soft_tissue", name, least, most, **{k: x for k, x in NUMBERS.items() if k != name})
    assert accepts("soft_tissue", **NUMBERS, trials=[1, 1_000_000])
    assert not accepts("soft_tissue", **NUMBERS, trials=[0])
    assert not accepts("soft_tissue", **NUMBERS, trials=[1_000_001])
