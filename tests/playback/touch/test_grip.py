"""Where an arm is touched, and by a hand of which only some things are known."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from playback.touch.grip import Grip, Hand


def test_grips_of_one_point_are_the_same() -> None:
    assert Grip(2, (0.3, 0.0, 0.0)) == Grip(2, (0.3, 0.0, 0.0))
    assert Grip(2, (0.3, 0.0, 0.0)) != Grip(1, (0.3, 0.0, 0.0))
    with pytest.raises(FrozenInstanceError):
        Grip(1, (0.0, 0.0, 0.0)).joint = 2  # type: ignore[misc]


def test_of_a_hand_only_its_place_must_be_known() -> None:
    hand = Hand(np.array([0.1, 0.2, 0.3]))
    assert hand.velocity is None and hand.orientation is None
