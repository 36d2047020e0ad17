"""Frames on the serial line: their bytes, and what INFO may say."""

import json
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from limbcal.errors import ProtocolError
from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import (
    SamplesFrame,
    SamplesRun,
    encode_info,
    encode_samples,
    header_crc,
)
from protocol.serial_parser import FrameParser

CHANNELS = tuple(Channel(f"s{s}{axis}", 0.0015, -0.2, 49.0) for s in (1, 2, 3, 4) for axis in "xyz")
INFO = DeviceInfo("limb-x", "0007", "1.2.3", 32000.0, 1e6, CHANNELS)

counts = hnp.arrays(np.int16, st.tuples(st.integers(1, 40), st.integers(1, 16)))
sequences = st.integers(0, 2**32 - 1)
ticks = st.integers(0, 2**64 - 1)


def test_header_crc_is_ccitt_false():
    assert header_crc(b"123456789") == 0x29B1  # the catalogue's check value


def test_bytes_of_a_samples_frame_are_those_of_the_contract():
    frame = encode_samples(np.array([[1, -2, 3], [4, 5, -6]], np.int16), 0x01020304, 0x1122334455667788)
    assert frame[0:2] == b"\xa5\x5a"
    assert frame[2] == 1
    assert frame[3] == 2
    assert frame[4:8] == b"\x04\x03\x02\x01"
    assert frame[8:16] == b"\x88\x77\x66\x55\x44\x33\x22\x11"
    assert frame[16:18] == b"\x02\x00"
    assert frame[18:20] == b"\x03\x00"
    assert frame[20:22] == b"\x0c\x00"
    assert frame[22:24] == struct.pack("<H", header_crc(frame[:22]))
    assert frame[24:36] == struct.pack("<6h", 1, -2, 3, 4, 5, -6)
    assert frame[36:] == struct.pack("<I", zlib.crc32(frame[24:36]))


def test_payload_of_an_info_frame_is_the_json_of_the_contract():
    frame = encode_info(INFO, 0, 0)
    document = json.loads(frame[24:-4].decode("utf-8"))
    assert frame[3] == 1
    assert list(document) == ["device", "serial", "firmware", "rate_hz", "tick_hz", "channels"]
    assert document["channels"][0] == {"name": "s1x", "scale": 0.0015, "offset": -0.2, "full_scale": 49.0}


@given(counts, sequences, ticks)
def test_samples_round_trip(block, sequence, tick):
    (frame,) = FrameParser().feed(encode_samples(block, sequence, tick))
    assert isinstance(frame, SamplesFrame)
    assert (frame.sequence, frame.ticks) == (sequence, tick)
    assert frame.counts.dtype == np.int16
    assert frame.counts.flags.writeable and frame.counts.flags.aligned and frame.counts.flags.c_contiguous
    np.testing.assert_array_equal(frame.counts, block)


def test_sequence_wraps():
    (frame,) = FrameParser().feed(encode_samples(np.zeros((1, 1), np.int16), 2**32 + 5, 0))
    assert frame.sequence == 5


def test_sequence_wraps_inside_a_run():
    first, ones = 2**32 - 2, np.ones((2, 3), np.int16)
    (run,) = FrameParser().feed_runs(b"".join(encode_samples(ones, first + k, 100 * k) for k in range(4)))
    assert run.sequence == first and len(run.ticks) == 4
    assert [frame.sequence for frame in run.frames()] == [first, first + 1, 0, 1]
    assert run.last().sequence == 1


def test_strided_counts_are_sent_in_order():
    block = np.arange(24, dtype=np.int16).reshape(4, 6)[::2, ::3]
    (frame,) = FrameParser().feed(encode_samples(block, 0, 0))
    np.testing.assert_array_equal(frame.counts, block)


@pytest.mark.parametrize(
    "block",
    [
        np.zeros((2, 2), np.int32),
        np.zeros((2, 2), np.uint16),
        np.zeros(4, np.int16),
        np.zeros((0, 3), np.int16),
        np.zeros((4000, 12), np.int16),
    ],
)
def test_counts_that_fit_no_frame_are_refused(block):
    with pytest.raises(ProtocolError):
        encode_samples(block, 0, 0)


@pytest.mark.parametrize("tick", [-1, 2**64])
def test_ticks_beyond_64_bits_are_refused(tick):
    with pytest.raises(ProtocolError, match="device clock"):
        encode_samples(np.zeros((1, 1), np.int16), 0, tick)


@pytest.mark.parametrize(("n_sample", "size"), [(32767, 65534), (32768, None)])
def test_a_payload_has_65535_bytes_at_most(n_sample, size):
    block = np.ones((n_sample, 1), np.int16)
    if size is None:
        with pytest.raises(ProtocolError, match="payload of 65536 bytes, expected at most 65535"):
            encode_samples(block, 0, 0)
    else:
        assert len(encode_samples(block, 0, 0)) == 24 + size + 4


@pytest.mark.parametrize("tick", [0, 2**64 - 1])
def test_any_ticks_of_64_bits_are_sent(tick):
    (frame,) = FrameParser().feed(encode_info(INFO, 2**32 - 1, tick))
    assert (frame.ticks, frame.sequence, frame.info) == (tick, 2**32 - 1, INFO)


def test_a_run_is_taken_apart_frame_by_frame():
    block = np.arange(12, dtype=np.int16).reshape(6, 2)
    run = SamplesRun(7, [100, 200, 300], block)
    assert run.frame_samples == 2
    assert [(one.sequence, one.ticks, one.counts.tolist()) for one in run.frames()] == [
        (7, 100, [[0, 1], [2, 3]]),
        (8, 200, [[4, 5], [6, 7]]),
        (9, 300, [[8, 9], [10, 11]]),
    ]
    assert (run.last().sequence, run.last().ticks, run.last().counts.tolist()) == (9, 300, [[8, 9], [10, 11]])
