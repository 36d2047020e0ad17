"""What a tracker gives out."""

import numpy as np

from tracking.model.frames import Frames


def test_a_block_knows_how_many_frames_it_holds():
    still = np.zeros((3, 2))
    assert Frames(0, 0, 1e-3, still, still, still, np.zeros((3, 3)), np.zeros((3, 4, 3)), False).n == 3
