"""Draws of a motion, and some instants of them."""

import numpy as np

from tracking.model.draws import Draws


def test_rows_are_instants_of_every_draw() -> None:
    rng = np.random.default_rng(0)
    whole = Draws(*(rng.normal(size=(3, 8, 2)) for _ in range(3)), rng.normal(size=(3, 8, 1, 3)))
    part = whole.rows(slice(2, 7, 2))
    for name in ("q", "dq", "ddq", "points"):
        for d in range(3):
            for row, instant in enumerate((2, 4, 6)):
                np.testing.assert_array_equal(getattr(part, name)[d][row], getattr(whole, name)[d][instant])
        assert getattr(part, name).shape[:2] == (3, 3)
