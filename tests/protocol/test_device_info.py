"""INFO says what it may, or its sentence says what is wrong with it, in characters that can be printed."""

import json
from dataclasses import asdict, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import ProtocolError
from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import InfoFrame, encode_info
from protocol.serial_parser import FrameParser

CHANNELS = tuple(Channel(f"s{s}{axis}", 0.0015, -0.2, 49.0) for s in (1, 2, 3, 4) for axis in "xyz")
INFO = DeviceInfo("limb-x", "0007", "1.2.3", 32000.0, 1e6, CHANNELS)

texts = st.text(st.characters().filter(str.isprintable), max_size=20)
sizes = st.floats(1e-12, 1e4)
channels = st.builds(
    Channel, texts, st.one_of(sizes, sizes.map(float.__neg__)), st.floats(-1e8, 1e8), st.floats(1e-9, 1e8)
)
infos = st.builds(
    DeviceInfo,
    *(texts for _ in range(3)),
    st.floats(0.1, 1e6),
    st.floats(0.1, 1e12),
    st.lists(channels, min_size=1, max_size=6, unique_by=lambda channel: channel.name).map(tuple),
)
sequences = st.integers(0, 2**32 - 1)
ticks = st.integers(0, 2**64 - 1)


@given(infos, sequences, ticks)
def test_info_round_trip(info, sequence, tick):
    assert FrameParser().feed(encode_info(info, sequence, tick)) == [InfoFrame(sequence, tick, info)]


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
        (_with(rate_hz=0), r"rate_hz is 0, expected a number of 0.1 to 1e\+06"),
        (_with(rate_hz=True), "rate_hz is True, expected a finite number"),
        (_with(rate_hz=float("nan")), "rate_hz is nan"),
        (_with(tick_hz=10**400), "tick_hz is an integer of more than 40 digits"),
        (_with(channels=[]), "at least one channel"),
        (_with(channels=[7]), r"channels\[0\] is 7, expected an object"),
        (_with(channels=[asdict(CHANNELS[0])] * 2), "each only once"),
        (_with_channel(scale=0), r"channels\[1\]: scale is 0, expected a number of 1e-12 to 10000 with either"),
        (_with_channel(scale=-1e300), r"channels\[1\]: scale is -1e\+300, expected"),
        (_with_channel(offset=1e12), r"channels\[1\]: offset is 1e\+12, expected a number of up to 1e\+08"),
        (_with_channel(full_scale=1e12), r"channels\[1\]: full_scale is 1e\+12"),
        (_with_channel(name="s1x\x1b[2J"), r"channels\[1\]: name is 's1x\\x1b\[2J', expected only characters"),
        (_with(rate_hz=1e12), r"rate_hz is 1e\+12, expected a number of 0.1 to 1e\+06"),
        (_with(rate_hz=1e-9), "rate_hz is 1e-09"),
        (_with(tick_hz=0), "tick_hz is 0, expected a number of 0.1 to"),
        (_with(tick_hz=1e15), r"tick_hz is 1e\+15"),
        (_with(channels=[{**asdict(CHANNELS[0]), "name": f"s{k}"} for k in range(10_000)]), "10000 entries"),
        (_with(device="\ud800"), r"device is '\\ud800', expected only characters that can be printed"),
        (_with(serial="\n<0>kernel: panic"), r"serial is '\\n<0>kernel: panic'"),
        (_with(firmware="\x1b]0;owned\x07"), r"firmware is '\\x1b\]0;owned\\x07'"),
        (_with(device="a\u202eb"), r"device is 'a\\u202eb'"),
        (_with(device="a\x00b"), r"device is 'a\\x00b'"),
        (_with(serial="x" * 129), "serial has 129 characters, expected at most 128"),
        (_with_channel(offset="x"), r"channels\[1\]: offset is 'x'"),
        (_with_channel(full_scale=-1), r"channels\[1\]: full_scale is -1"),
        (_with_channel(name=None), r"channels\[1\]: name is missing"),
    ],
)
def test_info_says_what_is_wrong_with_it(payload, said):
    with pytest.raises(ProtocolError, match=said) as refused:
        DeviceInfo.from_json(payload)
    assert str(refused.value).isprintable() and len(str(refused.value)) < 300


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


def test_a_letter_of_another_alphabet_is_one_of_utf_8():
    assert '"µ-limb"'.encode() in replace(INFO, device="µ-limb").to_json()
