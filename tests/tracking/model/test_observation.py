"""How the state is laid out."""

from dataclasses import replace

import numpy as np

from tracking.model.observation import MOUNTING, MOUNTING_NAMES, observation_of


def coupled(arm):
    return replace(arm, sensors=tuple(replace(sensor, highpass_hz=0.2) for sensor in arm.sensors))


def test_the_state_is_laid_out_as_it_says(dd_arm, sliding):
    of, size = observation_of(dd_arm)
    assert size == 6 + 12 + 2  # of link 1 its length a, of joint 2 the shift d
    np.testing.assert_array_equal(of.length_column, [[18, -1], [-1, 19]])
    of, size = observation_of(sliding)
    assert size == 6 + 9 + 1  # a sliding joint's shift is its own zero
    np.testing.assert_array_equal(of.length_column, [[15, -1], [-1, -1]])
    of, size = observation_of(coupled(dd_arm), True)
    assert size == 6 + 12 + 2 + 4 * (3 + 1) + 4 * MOUNTING
    columns = np.concatenate(
        [
            of.length_column[of.length_column >= 0],
            *(np.arange(s, s + 3) for s in of.settled_column),
            of.corner_column,
            *(np.arange(m, m + MOUNTING) for m in of.mounting_column),
        ]
    )
    np.testing.assert_array_equal(np.sort(columns), np.arange(18, size))
    np.testing.assert_allclose(of.corner, 2 * np.pi * 0.2)


def test_the_names_of_a_mounting_are_in_the_order_of_its_columns():
    assert len(MOUNTING_NAMES) == MOUNTING == 9
    assert MOUNTING_NAMES[:4] == ("scale_x", "scale_y", "scale_z", "turn_x") and MOUNTING_NAMES[8] == "place_z"


def test_what_the_model_lacks_comes_last(dd_arm):
    plain, n = observation_of(dd_arm, mountings=True)
    of, size = observation_of(dd_arm, mountings=True, base=True, lack=True)
    assert (of.base_column, of.lack_column, size) == (n, n + 3, n + 3 + 12)
    np.testing.assert_array_equal(of.reported, [*range(6), *range(n, size)])
    np.testing.assert_array_equal(plain.reported, range(6))
    assert observation_of(dd_arm, lack=True)[0].base_column < 0


def test_a_channel_depends_on_the_joints_between_base_and_sensor(branching):
    """The second branch hangs beside the first link's far end: that link's length is no matter to it."""
    of, _ = observation_of(branching)
    a, d = of.length_column[0, 0], of.length_column[2, 1]
    np.testing.assert_array_equal(of.length_column >= 0, [[True, False], [False, True], [False, True]])
    last = of.columns[-1, : of.n_column[-1]]
    assert {0, 1, 2, 6, 7, 8, d} <= set(last) and not {3, 4, 5} & set(last)
    middle = of.columns[9, : of.n_column[9]]
    assert {0, 1, 2, 3, 4, 5, a} <= set(middle) and not {6, 7, 8} & set(middle)
