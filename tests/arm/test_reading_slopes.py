"""Slopes of a link's motion against central differences of the recursion itself."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.chain import chain_of, poses
from arm.newton_euler import rigid_motion
from arm.reading_slopes import SEEDS, at_lever, lever_slope, motion_slopes

FEW = settings(max_examples=40, deadline=None)
STEP = 1e-5
#: The lengths of a joint, by the place of their slope.
LENGTHS = {3: "a_m", 4: "d_m"}


def rigid(chain, q, dq, ddq):
    n = q.size
    R, p, motion = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3, 3))
    poses(chain, q, R, p)
    rigid_motion(chain, chain.gravity, R, p, dq, ddq, motion)
    return R, p, motion


def slopes_of(chain, q, dq, ddq):
    n = q.size
    slopes = np.zeros((n, SEEDS * n, 3, 3))
    motion_slopes(chain, *rigid(chain, q, dq, ddq), dq, slopes)
    return slopes


def longer(arm, j, name, step):
    one = replace(arm.joints[j], **{name: getattr(arm.joints[j], name) + step})
    return replace(arm, joints=(*arm.joints[:j], one, *arm.joints[j + 1 :]))


def by_differences(arm, q, dq, ddq):
    """Return the same slopes, each by moving what it is taken by to either side."""
    n = q.size
    slopes = np.empty((n, SEEDS * n, 3, 3))
    for j in range(n):
        for k in range(SEEDS):
            sides = []
            for step in (STEP, -STEP):
                moved, other = np.stack([q, dq, ddq]), arm
                if k in LENGTHS:
                    other = longer(arm, j, LENGTHS[k], step)
                else:
                    moved[k, j] += step
                sides.append(rigid(chain_of(other), *moved)[2])
            slopes[:, SEEDS * j + k] = (sides[0] - sides[1]) / (2.0 * STEP)
    return slopes


@FEW
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_slopes_are_those_of_central_differences(random_arm, random_motion, seed, branching):
    """By q, dq, ddq, a and d of every joint, turning or sliding, with every link's motion."""
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = (rows[0] for rows in random_motion(arm, rng, 1))
    chain = chain_of(arm)
    expected = by_differences(arm, q, dq, ddq)
    largest = max(1.0, np.abs(rigid(chain, q, dq, ddq)[2]).max())
    np.testing.assert_allclose(slopes_of(chain, q, dq, ddq), expected, rtol=1e-6, atol=1e-7 * largest)


def test_both_kinds_of_joint_are_among_the_random_arms(random_arm):
    kinds = {joint.type for seed in range(10) for joint in random_arm(np.random.default_rng(seed)).joints}
    assert kinds == {"revolute", "prismatic"}


def test_what_lies_further_out_moves_no_link(random_arm, random_motion):
    """Only slopes by joints up to a link's own are filled in; its own length a moves the links behind it."""
    rng = np.random.default_rng(3)
    arm = random_arm(rng, n_joint=5, prismatic=False)
    slopes = slopes_of(chain_of(arm), *(rows[0] for rows in random_motion(arm, rng, 1)))
    for i in range(5):
        np.testing.assert_array_equal(slopes[i, SEEDS * (i + 1) :], 0.0)
        np.testing.assert_array_equal(slopes[i, SEEDS * i + 3], 0.0)
    assert np.abs(slopes[4, 3]).max() > 0.01


def test_room_may_be_used_again(random_arm, random_motion):
    """What an instant before left behind makes no difference."""
    rng = np.random.default_rng(11)
    arm = random_arm(rng, n_joint=4)
    chain = chain_of(arm)
    motions = [tuple(rows[0] for rows in random_motion(arm, rng, 1)) for _ in range(2)]
    slopes = slopes_of(chain, *motions[0])
    motion_slopes(chain, *rigid(chain, *motions[1]), motions[1][1], slopes)
    np.testing.assert_array_equal(slopes, slopes_of(chain, *motions[1]))


def test_a_lever_adds_what_the_formula_says():
    w, dw, s, tw, tdw = np.random.default_rng(5).normal(size=(5, 3))

    def felt(w, dw):
        return np.cross(dw, s) + np.cross(w, np.cross(w, s))

    np.testing.assert_allclose(at_lever(tuple(w), tuple(dw), tuple(s)), felt(w, dw), rtol=1e-13, atol=1e-14)
    slope = (felt(w + STEP * tw, dw + STEP * tdw) - felt(w - STEP * tw, dw - STEP * tdw)) / (2.0 * STEP)
    found = lever_slope(tuple(w), tuple(tw), tuple(tdw), tuple(s))
    np.testing.assert_allclose(found, slope, rtol=1e-8, atol=1e-9)
