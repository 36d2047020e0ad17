"""The device is known by its INFO, or what it sent instead is said."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from daemon.acquisition.handshake import Handshake, check_channels, same_device
from daemon.acquisition.ring import Chunk, Mark
from limbcal.errors import DeviceError
from protocol.serial_frame import encode_info, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info


def test_info_is_found_after_garbage_and_in_pieces() -> None:
    handshake = Handshake(FrameParser(), "/dev/ttyX")
    stream = b"boot: hello\xa5\x5a\x00" + encode_info(device_info(), 3, 0)
    assert handshake.hear([Chunk(0, stream[:50]), Chunk(1, stream[50:200])]) is None
    found = handshake.hear([Chunk(2, stream[200:])])
    assert found is not None
    assert found.info == device_info()


@pytest.mark.parametrize(
    ("sent", "said"),
    [
        (b"", "port /dev/ttyX: the device sent nothing within 0 s, expected the device's INFO frame"),
        (b"x" * 1000, "no valid frame in 1000 bytes"),
        (encode_samples(np.zeros((2, 12), dtype=np.int16), 0, 0), "1 frames of samples and no INFO frame"),
    ],
)
def test_what_came_instead_is_said(sent: bytes, said: str) -> None:
    handshake = Handshake(FrameParser(), "/dev/ttyX", limit_s=0.0)
    with pytest.raises(DeviceError, match=said):
        handshake.hear([Chunk(0, sent)])


def test_channels_must_be_the_arms_sensors() -> None:
    arm = load_arm("dd-arm")
    check_channels(device_info(), arm, "/dev/ttyX")
    with pytest.raises(DeviceError, match="channels are ax ay az, expected the sensors of arm 'dd-arm': s1x s1y"):
        check_channels(device_info(names=["ax", "ay", "az"]), arm, "/dev/ttyX")


def test_only_what_samples_mean_makes_another_device() -> None:
    assert same_device(device_info(), device_info())
    one = device_info()
    assert not same_device(one, device_info(16000.0))
    assert not same_device(one, replace(one, tick_hz=2.0 * one.tick_hz))
    assert not same_device(one, replace(one, serial="2"))
    assert not same_device(one, replace(one, device="another"))
    assert not same_device(one, replace(one, channels=one.channels[::-1]))
    other = (replace(one.channels[0], offset=1.0), *one.channels[1:])
    assert not same_device(one, replace(one, channels=other))
    assert same_device(one, replace(one, firmware="2"))


def test_the_stream_is_what_comes_after_what_came_with_the_info() -> None:
    handshake = Handshake(FrameParser(), "/dev/ttyX")
    samples = encode_samples(np.zeros((2, 12), dtype=np.int16), 4, 700)
    found = handshake.hear([Chunk(0, encode_info(device_info(), 3, 0)), Chunk(1, samples)])
    assert found is not None
    assert (found.sequence, found.ticks, found.info) == (4, 700, device_info())


def test_an_info_that_comes_with_the_last_bytes_is_heard() -> None:
    handshake = Handshake(FrameParser(), "/dev/ttyX", limit_s=-1.0)
    assert handshake.hear([Chunk(0, encode_info(device_info(), 3, 0))]) is not None


def test_of_several_infos_the_last_counts_and_samples_before_it_do_not() -> None:
    samples = encode_samples(np.zeros((2, 12), dtype=np.int16), 4, 700)
    stream = samples + encode_info(device_info(), 5, 800) + encode_info(device_info(16000.0), 6, 900)
    found = Handshake(FrameParser(), "/dev/ttyX").hear([Chunk(0, stream)])
    assert found is not None and (found.sequence, found.ticks, found.info.rate_hz) == (6, 900, 16000.0)


@pytest.mark.parametrize(("mark", "heard"), [(Mark.OPENED, False), (Mark.LOST, False), (Mark.ASKED, True)])
def test_a_frame_goes_on_after_a_question_and_begins_anew_with_a_port(mark: Mark, heard: bool) -> None:
    info = encode_info(device_info(), 3, 0)
    chunks = [Chunk(0, info[:40]), Chunk(1, b"", mark), Chunk(2, info[40:])]
    assert (Handshake(FrameParser(), "/dev/ttyX").hear(chunks) is not None) == heard


def test_what_was_wrong_with_a_frame_is_said() -> None:
    handshake = Handshake(FrameParser(), "/dev/ttyX", limit_s=-1.0)
    wrong = encode_info(replace(device_info(), serial="a\x00b"), 1, 0)
    with pytest.raises(DeviceError, match=r"no valid frame in \d+ bytes \(serial frame: INFO: serial is"):
        handshake.hear([Chunk(0, wrong)])
