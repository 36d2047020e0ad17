"""Over which interval the loop reckons: that of its ticks, or of the device where that is slower."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from arm.arm_file import load_arm
from playback.touch.limit import Coupling
from playback.touch.loop import Setup, TouchLoop
from playback.touch.pace import Pace
from playback.touch.touched_arm import TouchedArm

PERIOD_S, TICK_S = 1.0 / 1000.0, 1.0 / 1024.0
#: The first tick of that length at which a tenth of a second is over.
WINDOW = 103


@pytest.fixture
def loop(own_context: Any) -> Iterator[TouchLoop]:
    arm, coupling = load_arm("dd-arm"), Coupling()
    touched = TouchedArm(arm, np.zeros(2), PERIOD_S, coupling)
    made = TouchLoop(own_context, Setup(arm, (0.0, 0.0), 1000.0, coupling), touched, Pace(PERIOD_S, lambda: 8.0))
    yield made
    made.close()


def interval_ms(loop: TouchLoop) -> float:
    return float(str(loop.health()["interval_ms"]))


@pytest.mark.parametrize(
    ("held", "every", "slower_s"),
    [(True, 2, WINDOW * TICK_S / 51), (True, 1, TICK_S), (True, 1000, TICK_S), (False, 2, TICK_S)],
    ids=["slow", "fast", "silent", "nobody's"],
)
def test_three_tenths_of_what_is_measured_counts_at_once(
    loop: TouchLoop, held: bool, every: int, slower_s: float
) -> None:
    loop._holder = b"device" if held else None
    expected = PERIOD_S
    for window in range(3):
        for k in range(1, WINDOW + 1):
            assert interval_ms(loop) == pytest.approx(1e3 * expected)  # until a tenth of a second is over
            loop._measure(8.0 + (WINDOW * window + k) * TICK_S, k % every == 0)
        expected = 0.7 * expected + 0.3 * slower_s
        assert interval_ms(loop) == pytest.approx(1e3 * expected)
    assert loop.health()["inputs"] == 3 * (WINDOW // every)
