"""Room to work in: as large as the arm, and empty where what is in it counts."""

import numpy as np
import pytest

from arm.room import make_room


@pytest.mark.parametrize(("n", "n_past"), [(1, 0), (4, 25)])
def test_it_is_as_large_as_the_arm(n, n_past):
    room = make_room(n, n_past)
    assert room.R.shape == room.motion.shape == (n, 3, 3) and room.p.shape == (n, 3)
    assert room.A.shape == room.M.shape == (n, n) and room.branch.shape == (n, 10)
    for vector in (room.net, room.bias, room.now, room.slip, room.hold, room.directed):
        assert vector.shape == (n,)
    assert room.way.past.shape == (n_past, 2, n) and room.way.state.shape[1] == n
    assert len(room.zero) >= max(n, 6)  # a row of zeros, and room for a wrench of zeros


def test_at_first_all_of_a_command_arrives():
    room = make_room(2, 3)
    assert room.way.state.sum() == 2.0 and set(np.unique(room.way.state)) == {0.0, 1.0}
    assert not (room.zero.any() or room.branch.any() or room.way.past.any())


def test_two_rooms_share_nothing():
    one, other = make_room(2, 3), make_room(2, 3)
    one.zero[:], one.way.state[:], one.way.past[:] = 7.0, 7.0, 7.0
    assert not other.zero.any() and other.way.state.sum() == 2.0 and not other.way.past.any()
