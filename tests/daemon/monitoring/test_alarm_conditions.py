"""What one report after another gives away."""

from dataclasses import replace
from typing import Any

import pytest

from daemon.acquisition.ring import Chunk
from daemon.monitoring.alarm_conditions import AlarmConditions
from daemon.reception.reception import Reception
from protocol.device_info import DeviceInfo
from protocol.serial_frame import InfoFrame, encode_info, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info, resting_counts

RATE_HZ = 8000.0
FREE_BYTES = 100_000_000


def conditions(info: DeviceInfo) -> tuple[Reception, AlarmConditions]:
    taker = Reception(FrameParser(), InfoFrame(0, 0, info))
    return taker, AlarmConditions(taker, [channel.name for channel in info.channels], FREE_BYTES)


def look(
    taker: Reception, looker: AlarmConditions, health: dict[str, Any], records: bool
) -> dict[tuple[str, str], str]:
    return looker.look(health, taker.watch.take(), records)


def health(**changed: Any) -> dict[str, Any]:
    return {
        "connected": True,
        "latency_ms": {"p99": 8.0},
        "tracking": {"wrong": False},
        "rate_hz": 8000.1,
        "rate": {"claimed_hz": 8000.0, "in_use_hz": 8000.0, "std_ppm": 1.0},
        "clock_ppm": 40.0,
        "clock": {"ppm_std": 0.1, "host_ahead_s": 0.0},
        "disk_free_bytes": 10**12,
        "recording": "recording.mcap",
        **changed,
    }


@pytest.mark.parametrize(
    ("name", "changed"),
    [
        ("disconnected", {"connected": False}),
        ("behind", {"latency_ms": {"p99": 300.0}}),
        ("contradiction", {"tracking": {"wrong": True}}),
        ("rate", {"clock_ppm": -900.0}),
        ("rate", {"rate_hz": 7680.0}),
        ("clock", {"clock": {"ppm_std": 0.1, "host_ahead_s": -3600.0}}),
        ("disk", {"disk_free_bytes": 5 * FREE_BYTES}),
        ("not recorded", {"recording": None}),
    ],
)
def test_what_a_report_shows_is_wrong_for_as_long_as_it_is(name: str, changed: dict[str, Any]) -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    assert look(taker, looker, health(), records=True) == {}
    assert [found for found, _ in look(taker, looker, health(**changed), records=True)] == [name]
    assert look(taker, looker, health(), records=True) == {}


def test_where_no_recording_was_asked_for_none_is_missed() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    assert look(taker, looker, health(recording=None, disk_free_bytes=None), records=False) == {}


def test_a_rate_that_is_not_known_well_is_no_fault() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    rate = {"claimed_hz": 8000.0, "in_use_hz": 8000.0, "std_ppm": 200.0}
    unsure = health(rate_hz=8007.2, rate=rate, clock_ppm=900.0, clock={"ppm_std": 200.0, "host_ahead_s": 0.0})
    assert look(taker, looker, unsure, records=True) == {}


def test_a_rate_is_said_with_what_info_says() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    wrong = look(taker, looker, health(rate_hz=7680.0, clock_ppm=-40_000.0), records=True)
    assert wrong == {
        ("rate", ""): "it samples at 7680.00 ± 0.02 Hz, 4.00 % slower than the 8000 Hz of its INFO; "
        "its clock is 4.00 % slower than this machine's"
    }


def test_losses_and_garbage_are_of_the_time_since_the_last_report() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    look(taker, looker, health(), records=True)
    frames = [encode_samples(resting_counts(32), k + 1, 50 + 4000 * k) for k in range(20)]
    taker.take([Chunk(1, b"".join(frames[:10] + frames[11:]))])
    assert ("losses", "") in look(taker, looker, health(), records=True)
    taker.take([Chunk(2, bytes(5000))])
    found = look(taker, looker, health(), records=True)
    assert ("garbage", "") in found and ("losses", "") not in found
    assert look(taker, looker, health(), records=True) == {}


def test_a_recording_taken_away_is_an_alarm_for_good() -> None:
    taker, looker = conditions(device_info())
    for _ in range(3):
        wrong = looker.look(health(), taker.watch.take(), True, removed=2)
        assert wrong["removed", ""] == "2 so far while written, with what was in them"


def test_what_no_device_may_say_is_shown_by_its_field() -> None:
    taker, looker = conditions(device_info())
    assert ("nonsense", "") not in look(taker, looker, health(), True)
    hostile = encode_info(replace(device_info(), serial="x\x1b[2J"), 1, 0)
    taker.take([Chunk(0, hostile), Chunk(1, hostile)], 1)
    said = look(taker, looker, health(), True)["nonsense", ""]
    assert said.startswith("2 in the last second, at last serial frame: INFO: serial is 'x\\x1b[2J', expected")
    assert ("nonsense", "") not in look(taker, looker, health(), True)


def test_a_rate_without_an_error_is_said_in_full() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    rate = {"claimed_hz": 8000.0, "in_use_hz": 8000.0, "std_ppm": 0.0}
    wrong = look(taker, looker, health(rate_hz=8800.0, rate=rate, clock_ppm=None), records=True)
    said = "it samples at 8800.000000 ± 0.000000 Hz, 10.00 % faster than the 8000 Hz of its INFO"
    assert wrong == {("rate", ""): said}
    assert look(taker, looker, health(rate_hz=None, clock_ppm=None), records=True) == {}


def test_a_clock_error_is_shown_long_enough_to_alarm() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    taker.guard.errors = 4
    said = [look(taker, looker, health(), records=True).get(("clock", "device")) for _ in range(5)]
    assert said == ["it was off 4 times in all"] * 3 + [None] * 2
    taker.guard.errors = 5
    assert look(taker, looker, health(), records=True)["clock", "device"] == "it was off 5 times in all"


def test_a_clock_that_stands_still_is_wrong_for_as_long_as_it_does() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    taker.guard._off = True
    for _ in range(9):
        assert look(taker, looker, health(), True)["clock", "device"] == "it stands still or shows anything"
    taker.guard._off = False
    assert [("clock", "device") in look(taker, looker, health(), True) for _ in range(4)] == [
        True,
        True,
        False,
        False,
    ]


def test_another_device_on_the_port_is_named() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    taker.identity.stranger = "other device 7"
    assert look(taker, looker, health(), True)["stranger", ""] == "found other device 7, expected 1"


@pytest.mark.parametrize(("frames", "discarded", "garbage"), [(0, 7, True), (1, 7, False), (0, 0, False)])
def test_bytes_are_garbage_where_no_frame_came_with_them(frames: int, discarded: int, garbage: bool) -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    for _ in range(2):
        taker.parser.counters.frames += frames
        taker.parser.counters.discarded_bytes += discarded
        found = look(taker, looker, health(), records=True).get(("garbage", ""))
        assert found == ("7 bytes and no frame in the last second" if garbage else None)


def test_what_is_left_of_the_disk_is_said_in_megabytes() -> None:
    taker, looker = conditions(device_info(RATE_HZ))
    found = look(taker, looker, health(disk_free_bytes=123_400_000), records=True)
    assert found == {("disk", ""): "123 MB are left"}
    late = look(taker, looker, health(latency_ms={"p99": 250.4}), records=True)
    assert late == {("behind", ""): "a block in a hundred takes 250 ms and more"}
    set_back = look(taker, looker, health(clock={"ppm_std": 0.1, "host_ahead_s": -2.04}), records=True)
    assert set_back == {("clock", "host"): "it was set by -2.0 s in all"}
