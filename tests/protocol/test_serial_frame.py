"""Frames on the serial line: their bytes, and what INFO may say."""

import json
import struct
import zlib
from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from limbcal.errors import ProtocolError
from protocol.serial_frame import (
    Channel,
    DeviceInfo,
    InfoFrame,
    SamplesFrame,
    encode_info,
    encode_samples,
    header_crc,
)
from protocol.serial_parser import FrameParser

CHANNELS = tuple(Channel(f"s{s}{axis}", 0.0015, -0.2, 49.0) for s in (1, 2, 3, 4) for axis in "xyz")
INFO = DeviceInfo("limb-x", "0007", "1.2.3", 32000.0, 1e6, CHANNELS)

numbers = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(1e-300, 1e300)
channels = st.builds(Channel, st.text(max_size=8), numbers.filter(bool), numbers, positive)
infos = st.builds(
    DeviceInfo,
    *(st.text(max_size=20) for _ in range(3)),
    positive,
    positive,
    st.lists(channels, min_size=1, max_size=6, unique_by=lambda channel: channel.name).map(tuple),
)
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


@given(infos, sequences, ticks)
def test_info_round_trip(info, sequence, tick):
    assert FrameParser().feed(encode_info(info, sequence, tick)) == [InfoFrame(sequence, tick, info)]


def test_sequence_wraps():
    (frame,) = FrameParser().feed(encode_samples(np.zeros((1, 1), np.int16), 2**32 + 5, 0))
    assert frame.sequence == 5


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


def _with(**changes):
    return json.dumps({**asdict(INFO), **changes}).encode()


def _with_channel(**changes):
    return _with(channels=[asdict(CHANNELS[0]), {**asdict(CHANNELS[1]), **changes}])


@pytest.mark.parametrize(
    ("payload", "said"),
    [
        (b"\xff\xfe", "expected UTF-8 JSON"),
        (b"{", "expected UTF-8 JSON"),
        (b"[" * 100_000, "expected UTF-8 JSON"),
        (b"[1]", "expected an object"),
        (_with(device=3), "device is 3, expected a string"),
        (_with(rate_hz=0), "rate_hz is 0, expected a number above 0"),
        (_with(rate_hz=True), "rate_hz is True, expected a finite number"),
        (_with(rate_hz=float("nan")), "rate_hz is nan"),
        (_with(tick_hz=10**400), "tick_hz is an integer of more than 40 digits"),
        (_with(channels=[]), "at least one channel"),
        (_with(channels=[7]), r"channels\[0\] is 7, expected an object"),
        (_with(channels=[asdict(CHANNELS[0])] * 2), "each only once"),
        (_with_channel(scale=0), r"channels\[1\]: scale is 0"),
        (_with_channel(offset="x"), r"channels\[1\]: offset is 'x'"),
        (_with_channel(full_scale=-1), r"channels\[1\]: full_scale is -1"),
        (_with_channel(name=None), r"channels\[1\]: name is missing"),
    ],
)
def test_info_says_what_is_wrong_with_it(payload, said):
    with pytest.raises(ProtocolError, match=said):
        DeviceInfo.from_json(payload)


@given(st.binary(max_size=200))
def test_info_raises_nothing_else(payload):
    try:
        DeviceInfo.from_json(payload)
    except ProtocolError:
        pass


def test_info_passes_over_keys_of_a_later_firmware():
    assert DeviceInfo.from_json(_with(temperature=21)) == INFO


def test_info_that_is_no_number_is_not_sent():
    with pytest.raises(ValueError, match="JSON compliant"):
        encode_info(replace(INFO, rate_hz=float("inf")), 0, 0)
