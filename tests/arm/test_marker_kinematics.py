"""Markers' places against the arm's own frames, and their slopes against central differences."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from arm.chain import chain_of
from arm.kinematics import axis_frames
from arm.marker_kinematics import (
    ALPHA,
    BASE_POSITION,
    BASE_ROTATION,
    BETA,
    HANG_X,
    HANG_Y,
    HANG_Z,
    A,
    D,
    free_slopes,
    joint_slopes,
    link_frames,
    marker_at,
    marker_chain,
    slopes_room,
)

SEEDS = st.integers(0, 2**32 - 1)
FEW = settings(max_examples=15, deadline=None)


def drawn(random_arm, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    n = arm.n_joint
    revolute = np.array([joint.type == "revolute" for joint in arm.joints])
    chain = marker_chain(
        revolute,
        chain_of(arm).geometry.copy(),
        rng.integers(0, n, 3),
        rng.normal(size=(3, 3)),
        Rotation.random(1, rng).as_matrix()[0],
        rng.normal(size=3),
        chain_of(arm).parent,
        chain_of(arm).hang,
    )
    return arm, chain, rng.normal(size=n), Rotation.random(1, rng).as_matrix()[0], rng.normal(size=3)


def places(chain, R, p, q):
    room, y = slopes_room(len(q), 0), np.empty((3, 3))
    link_frames(chain, R, p, q, room)
    for m in range(3):
        marker_at(chain, room, m, y[m])
    return y


@FEW
@given(SEEDS, st.booleans())
def test_markers_are_where_the_links_are(random_arm, seed, branching):
    arm, chain, q, R, p = drawn(random_arm, seed, branching)
    frames = axis_frames(arm, q)[0]
    for m, y in enumerate(places(chain, R, p, q)):
        T = frames[chain.link[m]]
        in_frame_0 = T[:3, :3] @ chain.place[m] + T[:3, 3]
        np.testing.assert_allclose(y, R @ (chain.base_R @ in_frame_0 + chain.base_p) + p, atol=1e-12)


@FEW
@given(SEEDS, st.booleans())
def test_slopes_are_central_differences(random_arm, seed, branching):
    arm, chain, q, R, p = drawn(random_arm, seed, branching)
    n, h = arm.n_joint, 1e-6
    free = np.array(
        [(kind, i) for kind in (ALPHA, A, D, BETA) for i in range(n)]
        + [(kind, i) for kind in (BASE_POSITION, BASE_ROTATION) for i in range(3)]
        + [(kind, i) for kind in (HANG_X, HANG_Y, HANG_Z) for i in range(n)]
    )
    room = slopes_room(n, len(free))
    link_frames(chain, R, p, q, room)

    def moved(kind, i, step):
        geometry, hang = chain.geometry.copy(), chain.hang.copy()
        base_R, base_p = chain.base_R, chain.base_p.copy()
        if kind == BASE_POSITION:
            base_p[i] += step
        elif kind == BASE_ROTATION:
            base_R = base_R @ Rotation.from_rotvec(step * np.eye(3)[i]).as_matrix()
        elif kind >= HANG_X:
            hang[i, 1 + kind - HANG_X] += step
        else:
            geometry[i, kind] += step
        one = marker_chain(chain.revolute, geometry, chain.link, chain.place, base_R, base_p, chain.parent, hang)
        return places(one, R, p, q)

    by_q = [(places(chain, R, p, q + h * e) - places(chain, R, p, q - h * e)) / (2 * h) for e in np.eye(n)]
    by_free = [(moved(kind, i, h) - moved(kind, i, -h)) / (2 * h) for kind, i in free]
    y = places(chain, R, p, q)
    for m in range(3):
        joint_slopes(chain, room, m, y[m])
        free_slopes(chain, room, R, free, m, y[m])
        np.testing.assert_allclose(room.by_q.T, [column[m] for column in by_q], atol=1e-7)
        np.testing.assert_allclose(room.by_free.T, [column[m] for column in by_free], atol=1e-7)
