"""How one segment moved relative to another."""

import numpy as np
import pytest

from fitter.functional.relative_motion import part_sums, relative_motion, turning
from fitter.functional.sufficient_rotation import joint_motion
from tests.fitter.functional.poses import segments, simulated, written_out
from tests.fitter.functional.simulated_limb import limb


def test_the_sums_of_all_parts_are_the_equations_written_out():
    limbs, _, _ = simulated("ball", 1, 300, trials=2)
    limbs[0].child_m[50:80] = np.nan
    parent, child = segments(limbs)
    motion = relative_motion(parent.trials, child.trials)
    sums = part_sums(motion, motion.parts.part)
    A, b = written_out(parent, child)
    assert np.allclose(sums.gram.sum(axis=0), A.T @ A)
    assert np.allclose(sums.rhs.sum(axis=0), A.T @ b)
    assert motion.n_frame == 570


@pytest.mark.parametrize(("column", "direction"), [(0, 0), (1, 1), (2, 2)])
def test_a_turn_about_one_axis_is_that_axis_and_its_rms(column, direction):
    angles = np.zeros((800, 3))
    angles[:, column] = np.radians(20.0) * np.sin(np.arange(800) / 30.0)
    rng = np.random.default_rng(2)
    x = limb(angles, rng, skin_m=0.0, skin_rad=0.0, noise_m=1e-6)
    parent, child = segments([x])
    motion = joint_motion("knee_right", parent, child)
    turned = turning(part_sums(motion, motion.parts.part).gram.sum(axis=0))
    axis = np.einsum("nji,nj->ni", parent.trials[0].R, x.R[:, :, direction])[0]
    assert abs(turned.in_parent[0] @ axis) == pytest.approx(1.0, abs=1e-6)
    rms = np.std(angles[:, column])
    assert turned.turned_rad == pytest.approx([0.0, rms, rms], abs=0.005)
    assert turned.about_rad == pytest.approx([rms, 0.0, 0.0], abs=0.005)
