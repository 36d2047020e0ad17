"""Segments of persons: against figures printed in the table's source, and Steiner's theorem."""

import numpy as np
import pytest

from arm.body.segments import SEGMENTS, segment
from arm.physical_links import is_possible, link_parameters


def test_the_mean_mans_forearm_is_that_of_the_table():
    one = segment("forearm", 73.0, 1.741, "m")
    assert (one.mass_kg, one.length_m, one.centre_m) == pytest.approx((1.1826, 0.2689, 0.1230), abs=1e-4)
    assert one.inertia_kg_m2 == pytest.approx((0.006514, 0.006005, 0.001252), rel=1e-3)


@pytest.mark.parametrize("name", SEGMENTS)
@pytest.mark.parametrize("sex", ["f", "m"])
def test_mass_goes_with_mass_and_length_with_stature(name, sex):
    one, heavier, taller = (segment(name, *person, sex) for person in ((60.0, 1.7), (90.0, 1.7), (60.0, 1.87)))
    assert heavier.mass_kg == pytest.approx(1.5 * one.mass_kg)
    assert heavier.length_m == one.length_m
    assert taller.length_m == pytest.approx(1.1 * one.length_m)
    assert taller.inertia_kg_m2 == pytest.approx(np.multiply(1.21, one.inertia_kg_m2))


@pytest.mark.parametrize("name", SEGMENTS)
def test_a_link_holds_its_segment_wherever_its_frame_stands(name):
    one = segment(name, 70.0, 1.75, "f")
    axes, begin = np.column_stack([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]), np.array([0.1, 0.2, 0.3])
    frame = np.eye(4)
    frame[:3, :3] = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    frame[:3, 3] = begin + one.centre_m * axes[:, 2]  # at the centre of mass
    link = one.link(begin, axes, frame)
    assert link.com_m == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    xx, yy, zz, xy, xz, yz = link.inertia_kg_m2
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    np.testing.assert_allclose(moments, np.sort(one.inertia_kg_m2), rtol=1e-9)
    assert is_possible(link_parameters(link))
