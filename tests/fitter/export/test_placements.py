"""Placements of an arm: joints in their parents, masses about their centres, gravity in the world."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.base_pose import is_carried
from arm.kinematics import axis_frames
from fitter.export.placements import link_name, placed_on, placements


def test_chained_placements_are_the_arms_frames(carried):
    placed = placements(carried)
    expected = axis_frames(carried, np.zeros((1, carried.n_joint)))[0]
    frames = {0: np.eye(4)}
    for i, parent in enumerate(placed.parents):
        frames[i + 1] = frames[parent] @ placed.joints[i]
        np.testing.assert_allclose(frames[i + 1], expected[i], atol=1e-12)
        name, at = placed_on(placed, i)
        assert name == link_name(parent)
        np.testing.assert_allclose(
            at, placed.frame_0 @ placed.joints[0] if i == 0 else placed.joints[i], atol=1e-12
        )
    np.testing.assert_allclose(placed.frame_0[:3, 3], carried.base.position_m)


def test_limbs_of_a_tree_hang_on_their_parents():
    body = load_arm("human-body")
    placed = placements(body)
    assert placed.parents == tuple(parent + 1 for parent in body.parents)
    first = next(i for i, parent in enumerate(body.parents) if parent not in (-1, i - 1))
    at = axis_frames(body, np.zeros((1, body.n_joint)))[0]
    np.testing.assert_allclose(at[body.parents[first]] @ placed.joints[first], at[first], atol=1e-12)


def test_links_are_counted_from_one_on_the_base():
    assert [link_name(i) for i in (0, 1, 12)] == ["base", "link1", "link12"]


def test_only_a_tracked_segment_carries(carried):
    assert is_carried(carried)
    assert not is_carried(replace(carried, base=None))
    assert not is_carried(replace(carried, base=replace(carried.base, segment=None)))


def test_inertias_are_about_the_centre_of_mass(carried):
    placed = placements(carried)
    link = carried.joints[4].link
    x, y, z = link.com_m
    assert placed.inertia_kg_m2[4, 0, 0] == pytest.approx(link.inertia_kg_m2[0] - link.mass_kg * (y * y + z * z))
    assert np.linalg.eigvalsh(placed.inertia_kg_m2[4]).min() > 0.0


def test_gravity_of_a_standing_base_is_turned_into_the_world(carried):
    standing = replace(carried, base=replace(carried.base, segment=None))
    R = Rotation.from_euler("ZYX", [0.7, -0.4, 0.2]).as_matrix()
    np.testing.assert_allclose(placements(standing).gravity_m_s2, R @ carried.gravity_m_s2, atol=1e-12)
    np.testing.assert_allclose(placements(carried).gravity_m_s2, carried.gravity_m_s2)
