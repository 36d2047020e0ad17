"""Both ends of what a device may say of itself."""

import json
from dataclasses import asdict
from typing import Any

import pytest

from limbcal.errors import ProtocolError
from protocol.device_info import Channel, DeviceInfo
from tests.protocol.test_device_info import INFO

CHANNEL = asdict(INFO.channels[0])


def read(**changes: Any) -> DeviceInfo:
    return DeviceInfo.from_json(json.dumps({**asdict(INFO), **changes}).encode())


def read_channel(**changes: Any) -> Channel:
    return read(channels=[{**CHANNEL, **changes}]).channels[0]


@pytest.mark.parametrize(
    ("field", "least", "most"),
    [("rate_hz", 0.1, 1e6), ("tick_hz", 0.1, 1e12)],
)
def test_numbers_of_the_device_end_where_they_say(field: str, least: float, most: float) -> None:
    for value in (least, most, 1000):
        assert getattr(read(**{field: value}), field) == value
    for value in (0.999 * least, 1.001 * most, -least, -1000.0):
        with pytest.raises(ProtocolError, match=f"INFO: {field} is .*, expected a number of 0.1 to"):
            read(**{field: value})


@pytest.mark.parametrize(
    ("field", "least", "most", "signed"),
    [("scale", 1e-12, 1e4, True), ("offset", 0.0, 1e8, True), ("full_scale", 1e-9, 1e8, False)],
)
def test_numbers_of_a_channel_end_where_they_say(field: str, least: float, most: float, signed: bool) -> None:
    for value in (least, most):
        assert getattr(read_channel(**{field: value}), field) == value
        if signed:
            assert getattr(read_channel(**{field: -value}), field) == -value
    wrong = [1.001 * most, -1.001 * most, *([0.999 * least] if least else []), *([] if signed else [-1.0])]
    for value in wrong:
        with pytest.raises(ProtocolError, match=rf"INFO: channels\[0\]: {field} is "):
            read_channel(**{field: value})


@pytest.mark.parametrize("field", ["device", "serial", "firmware"])
def test_texts_have_128_characters_at_most(field: str) -> None:
    assert getattr(read(**{field: "x" * 128}), field) == "x" * 128
    assert getattr(read(**{field: ""}), field) == ""
    with pytest.raises(ProtocolError, match=f"INFO: {field} has 129 characters, expected at most 128"):
        read(**{field: "x" * 129})


@pytest.mark.parametrize(("count", "fits"), [(1, True), (256, True), (257, False), (0, False)])
def test_a_device_has_one_to_256_channels(count: int, fits: bool) -> None:
    channels = [{**CHANNEL, "name": f"c{k}"} for k in range(count)]
    if fits:
        assert [one.name for one in read(channels=channels).channels] == [f"c{k}" for k in range(count)]
        return
    said = "channels has 257 entries, expected at most 256" if count else "expected a list of at least one channel"
    with pytest.raises(ProtocolError, match=said):
        read(channels=channels)


@pytest.mark.parametrize(("value", "said"), [(10**39, "device is 1000"), (10**40, "more than 40 digits")])
@pytest.mark.parametrize("sign", [1, -1])
def test_an_integer_of_many_digits_is_not_written_out(value: int, said: str, sign: int) -> None:
    with pytest.raises(ProtocolError, match=said if sign > 0 else said.replace("is 1", "is -1")):
        read(device=sign * value)


def test_what_was_found_is_shown_in_forty_bytes() -> None:
    with pytest.raises(ProtocolError) as caught:
        DeviceInfo.from_json(b"x" * 40 + b"yz")
    assert "x" * 40 in str(caught.value) and "y" not in str(caught.value).split("expected")[0]


def test_a_long_value_is_shown_by_its_first_57_characters() -> None:
    value = [{"a" * 20: "b" * 20}] * 5
    with pytest.raises(ProtocolError) as caught:
        read(rate_hz=value)
    shown = str(caught.value).partition(" is ")[2].partition(", expected")[0]
    assert shown.endswith("...") and len(shown) == 60
