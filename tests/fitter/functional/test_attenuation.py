"""How far turns of the skin draw a centre towards the markers."""

import numpy as np
import pytest

from fitter.functional.attenuation import skin_turns, without_attenuation
from fitter.functional.functional_centre import functional_centre
from fitter.functional.relative_motion import part_sums, turning
from fitter.functional.score import revealed_basis
from fitter.functional.sufficient_rotation import joint_motion
from tests.fitter.functional.poses import recorded, simulated
from tests.fitter.functional.test_score import HIP


def basis_of(motion):
    turned = turning(part_sums(motion, motion.parts.part).gram.sum(axis=0))
    return revealed_basis(turned, np.zeros(3, dtype=bool))


def test_turns_of_the_skin_are_found_of_both_segments():
    found = []
    for seed in range(8):
        limbs, parent, child = simulated("ball", seed, 1500, skin_m=0.0, skin_rad=0.05)
        both = np.concatenate([segment.place([limbs[0].p]) for segment in (parent, child)])
        found.append(skin_turns(joint_motion("hip_right", parent, child), both))
    parent, child = np.sqrt(np.mean(found, axis=0))
    assert child == pytest.approx(0.05, rel=0.2)
    assert 0.01 < parent < 0.04  # 0.025, by a lever half as long


def test_shifts_of_the_skin_are_not_turns():
    limbs, parent, child = simulated("ball", 1, 1500, skin_m=0.0, skin_rad=0.0, noise_m=0.003)
    both = np.concatenate([segment.place([limbs[0].p]) for segment in (parent, child)])
    turns = np.array(skin_turns(joint_motion("hip_right", parent, child), both))
    # markers that wander one by one turn the cluster a little, about some axes more than about others
    expected = [parent.turn_variance_rad2, child.turn_variance_rad2]
    assert np.sqrt(turns) == pytest.approx(np.sqrt(expected), rel=0.5)


def test_without_turns_it_is_score():
    _, parent, child = simulated("ball", 2, 600)
    motion = joint_motion("hip_right", parent, child)
    centre = functional_centre("hip_right", parent, child)
    plain = without_attenuation(motion, (0.0, 0.0), basis_of(motion))
    assert np.allclose(plain, np.concatenate([centre.in_parent_m, centre.in_child_m]), atol=1e-9)


def test_a_centre_without_the_attenuation_is_nearer_to_the_truth():
    plain, mended = [], []
    for seed in range(5):
        limbs, parent, child = simulated("ball", seed, 1000, trials=6, skin_m=0.0, skin_rad=0.05)
        centre = functional_centre("hip_right", parent, child)
        truth = parent.place([x.p for x in limbs])
        plain.append(centre.in_parent_m - truth)
        mended.append(centre.in_parent_m + centre.attenuation_m[:3] - truth)
    assert np.mean(np.square(mended)) < 0.6 * np.mean(np.square(plain))


def test_turns_of_any_size_leave_a_finite_centre():
    _, parent, child = simulated("ball", 3, 600)
    motion = joint_motion("hip_right", parent, child)
    assert np.all(np.abs(without_attenuation(motion, (0.9, 5.0), basis_of(motion))) < 2.0)


def test_intervals_hold_the_centre_although_skin_turns_by_three_degrees():
    held = []
    for seed in range(10):
        limbs, parent, child = simulated("ball", seed, 600, trials=4, skin_m=0.008, skin_rad=0.05)
        centre = functional_centre("hip_right", parent, child)
        held.append(np.abs(centre.in_parent_m - parent.place([x.p for x in limbs])) <= centre.half_width_m)
    assert np.mean(held) >= 0.85


def test_a_measured_hip_is_hardly_drawn():
    hip = recorded("btk/FunctionalLHip.c3d", HIP)
    centre = functional_centre("hip_left", hip["pelvis"], hip["thigh_left"])
    assert np.linalg.norm(centre.attenuation_m[:3]) < 0.002
