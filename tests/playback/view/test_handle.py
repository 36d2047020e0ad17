"""The tip in a real browser: dragged it moves the arm, and let go the arm springs back."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager

import numpy as np
import pytest

from tests.playback.view.conftest import Viewing, Window, eventually

REST = (0.4, 0.9)


@pytest.fixture(scope="module")
def touched(viewing: Callable[..., AbstractContextManager[Viewing]]) -> Iterator[Viewing]:
    """Show an arm that can be touched."""
    with viewing("--touch", "--arm", "dd-arm", "--q0", ",".join(map(str, REST))) as touched:
        yield touched


def test_the_tip_is_dragged_and_springs_back(touched: Viewing, window: Callable[[str], Window]) -> None:
    page = window(touched.facts["url"])
    eventually(lambda: bool(np.abs(page.joints() - REST).max() < 0.02), "an arm at rest")
    mouse = page.page.mouse
    x, y = page.place_of("/handle")
    rest = page.tip()
    mouse.move(x, y)
    mouse.down()
    for k in range(1, 6):
        mouse.move(x - 16 * k, y + 12 * k)
    pulled = eventually(
        lambda: q if np.abs((q := page.joints()) - REST).max() > 0.1 else None, "an arm that follows the hand"
    )
    ball, tip = page.node("/handle"), page.tip()
    assert ball is not None
    assert np.linalg.norm(np.array(ball["position"]) - tip) > 0.005  # the spring between the two is stretched
    assert (tip - rest) @ (np.array(ball["position"]) - rest) > 0.0  # it is pulled, not pushed
    mouse.up()
    eventually(lambda: bool(np.abs(page.joints() - REST).max() < 0.05), "an arm that is back where it rested")
    eventually(
        lambda: bool(np.linalg.norm(np.array(page.node("/handle")["position"]) - page.tip()) < 0.01),
        "a handle that is back at the tip",
    )
    assert np.abs(pulled - REST).max() > 0.1
