"""A device whose process did not run catches up in steps that its host can follow."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.virtual_device.device_time import DeviceTime


class Clock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_it_is_the_hosts_time_for_as_long_as_the_device_runs() -> None:
    clock = Clock()
    device = DeviceTime(clock)
    assert device.follow() == 100.0
    for pause_s in (0.005, 0.0, 0.0199, 0.005):
        clock.now_s += pause_s
        assert device.follow() == clock.now_s


def test_after_a_pause_it_catches_up_step_by_step() -> None:
    clock = Clock()
    device = DeviceTime(clock)
    clock.now_s += 1.0
    times = [100.0]
    while times[-1] < clock.now_s:
        clock.now_s += 0.005
        times.append(device.follow())
    steps = [after - before for before, after in pairwise(times)]
    assert steps[0] == pytest.approx(1.005 / 8)
    assert steps[0] == max(steps) and min(steps[:-1]) == pytest.approx(0.02)
    assert times[-1] == clock.now_s < 101.3


@given(st.lists(st.floats(0.0, 5.0), min_size=1, max_size=50))
def test_it_never_goes_back_nor_ahead_nor_stays_behind(
    pauses: list[float],
) -> None:
    clock = Clock()
    device = DeviceTime(clock)
    at_s = clock.now_s
    for pause_s in pauses:
        clock.now_s += pause_s
        before_s, at_s = at_s, device.follow()
        assert before_s <= at_s <= clock.now_s
        assert clock.now_s - at_s <= 7.0 * max(pauses)  # what an eighth of the lag at every run amounts to
