"""A joint that is put into a chain for tracking: at zero nothing moves, and what is behind it turns."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.missing_joints import with_joint
from fitter.limb.inverse_kinematics import link_poses, predicted
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task(n=4)


@pytest.mark.parametrize("on", [2, 8, 9])
def test_what_is_behind_turns_about_its_axis(known, on):
    chain, frames = known.markers.chain(known.geometry), known.task.frames
    axis, at = np.array([0.6, 0.0, -0.8]), np.array([0.1, 0.2, 0.3])
    more = with_joint(chain, on, axis, at)
    before, q = predicted(chain, frames, known.q), np.insert(known.q, on + 1, 0.0, axis=1)
    np.testing.assert_allclose(predicted(more, frames, q), before, atol=1e-12)
    q[:, on + 1] = 0.4
    R, o = (x[:, on] for x in link_poses(chain, frames, known.q))
    turn, point = R @ Rotation.from_rotvec(0.4 * axis).as_matrix() @ R.mT, R @ at + o
    turned = np.einsum("kij,kmj->kmi", turn, before - point[:, None]) + point[:, None]
    behind = chain.link >= on  # of a serial chain
    np.testing.assert_allclose(predicted(more, frames, q), np.where(behind[:, None], turned, before), atol=1e-12)
