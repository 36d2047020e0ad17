"""A device that has come back is believed when it has said what it is, and another one never."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from daemon.reception.device_identity import DeviceIdentity
from daemon.virtual_device.virtual_device import device_info
from protocol.device_info import DeviceInfo
from protocol.serial_frame import SamplesFrame


@pytest.fixture
def info() -> DeviceInfo:
    return device_info(load_arm("dd-arm"), 4000.0, 1)


def frame(number: int, n_channel: int) -> SamplesFrame:
    return SamplesFrame(number, 0, np.zeros((32, n_channel), dtype=np.int16))


def test_frames_of_the_right_width_are_used_at_once(info: DeviceInfo) -> None:
    identity, width = DeviceIdentity(info), len(info.channels)
    assert not identity.holds_back(frame(0, width), 7)
    assert identity.holds_back(frame(1, width - 1), 7)
    assert (identity.known, identity.strangers, identity.stranger) == (True, 1, None)


def test_frames_wait_until_the_same_device_says_that_it_is(info: DeviceInfo) -> None:
    identity, width = DeviceIdentity(info), len(info.channels)
    identity.came_back()
    waiting = [frame(k, width) for k in range(3)]
    assert all(identity.holds_back(one, 7) for one in waiting) and not identity.has(width)
    assert identity.meet(info) == [(one, 7) for one in waiting]
    assert identity.has(width) and identity.strangers == 0
    assert identity.meet(info) == []


def test_all_of_another_device_is_counted_with_its_info(info: DeviceInfo) -> None:
    identity, width = DeviceIdentity(info), len(info.channels)
    identity.came_back()
    assert identity.holds_back(frame(0, width), 7)
    assert identity.meet(replace(info, serial="other")) == []
    assert identity.holds_back(frame(1, width), 7)
    assert (identity.known, identity.strangers, identity.stranger) == (False, 3, f"{info.device} other")


def test_what_waited_for_a_device_that_left_again_is_nobodys(info: DeviceInfo) -> None:
    identity, width = DeviceIdentity(info), len(info.channels)
    identity.came_back()
    assert identity.holds_back(frame(0, width), 7) and identity.holds_back(frame(1, width), 7)
    identity.lost()
    assert identity.strangers == 2
    assert identity.meet(info) == []
