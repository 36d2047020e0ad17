"""Where an arm is touched, and by a hand of which only some things are known."""

from dataclasses import FrozenInstanceError

import pytest

from playback.touch.grip import Grip


def test_grips_of_one_point_are_the_same() -> None:
    assert Grip(2, (0.3, 0.0, 0.0)) == Grip(2, (0.3, 0.0, 0.0))
    assert Grip(2, (0.3, 0.0, 0.0)) != Grip(1, (0.3, 0.0, 0.0))
    with pytest.raises(FrozenInstanceError):
        Grip(1, (0.0, 0.0, 0.0)).joint = 2  # type: ignore[misc]
