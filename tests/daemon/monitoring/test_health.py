"""The heartbeat's numbers."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.monitoring.health import Delay, Latency, health_fields
from daemon.reception.channel_watch import Reading
from daemon.reception.reception import Reception
from protocol.device_info import DeviceInfo
from protocol.serial_frame import InfoFrame
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info
from tracking.model.frames import Frames
from tracking.model.innovation_test import Consistency

DT_S = 1e-3
T0_NS = 1_700_000_000_000_000_000


def block(first: int, n: int) -> Frames:
    two = np.zeros((n, 2))
    return Frames(first, T0_NS + first * 10**6, DT_S, two, two, two, np.zeros((n, 3)), np.zeros((n, 4, 3)), False)


def test_latency_is_of_the_time_since_it_was_last_asked() -> None:
    latency = Latency()
    assert latency.take() == {"p50": None, "p99": None, "p99_run": None}
    for milliseconds in range(1, 102):
        latency.note(milliseconds / 1000)
    run_ms = pytest.approx(100.0, rel=0.03)
    assert latency.take() == {"p50": pytest.approx(51.0), "p99": pytest.approx(100.0), "p99_run": run_ms}
    assert latency.take() == {"p50": None, "p99": None, "p99_run": run_ms}


@given(st.lists(st.tuples(st.integers(1, 12), st.integers(-5_000_000, 10**9)), min_size=1, max_size=20))
def test_delay_is_of_every_frame_by_its_own_stamp(blocks: list[tuple[int, int]]) -> None:
    delay, first, ages_ms = Delay(), 0, []
    for n, after_ns in blocks:
        delay.note(block(first, n), T0_NS + (first + n) * 10**6 + after_ns)
        ages_ms += [(n - k) + 1e-6 * after_ns for k in range(n)]
        first += n
    assert delay.take() == {
        "mean": pytest.approx(np.mean(ages_ms), abs=1e-6),
        "max": pytest.approx(max(ages_ms), abs=1e-6),
    }
    assert delay.take() == {"mean": None, "max": None}


def reading_of(samples: int, spread: Sequence[float]) -> Reading:
    none = np.zeros(6, dtype=np.int64)
    return Reading(samples, np.arange(1.0, 7.0), np.array(spread), np.full(6, 0.01), none, none, none)


def fields(reading: Reading, info: DeviceInfo, directory: str | None = None, n_rate: int = 0) -> dict[str, Any]:
    return health_fields(
        uptime_s=3.5,
        last_seq={"limb/raw": 7},
        reception=Reception(FrameParser(), InfoFrame(0, 0, info)),
        reading=reading,
        q=np.array([0.5, -1.0]),
        q_units=["rad", "m"],
        channel_names=["s1x", "s1y", "s1z", "s2x", "s2y", "s2z"],
        latency=Latency(),
        delay=Delay(),
        method="filter",
        consistency=Consistency(1.5, 2, 3, True),
        connected=False,
        recording=None,
        recording_lost=4,
        directory=directory,
        n_rate=n_rate,
    )


def test_what_a_gyroscope_reads_is_no_acceleration() -> None:
    info = device_info(8000.0, ["s1x", "s1y", "s1z", "s2x", "s2y", "s2z"])
    found = fields(reading_of(10, [0.0] * 6), info, n_rate=3)
    assert found["readings"] == {"s1": [1.0, 2.0, 3.0]}
    assert list(found["saturated"]) == ["s1x", "s1y", "s1z", "s2x", "s2y", "s2z"]


def test_sensors_are_told_by_their_three_axes() -> None:
    info = device_info(8000.0, ["s1x", "s1y", "s1z", "s2x", "s2y", "s2z"])
    found = fields(reading_of(10, [0.0] * 5 + [9.0]), info)
    assert found["readings"] == {"s1": [1.0, 2.0, 3.0], "s2": [4.0, 5.0, 6.0]}
    assert found["still"] == {"s1": True, "s2": False}
    assert found["saturated"] == found["flat"] == dict.fromkeys(["s1x", "s1y", "s1z", "s2x", "s2y", "s2z"], 0)
    none = fields(reading_of(0, [0.0] * 6), info)
    assert none["readings"] == {"s1": None, "s2": None}
    assert none["still"] == {"s1": False, "s2": False}


def test_what_is_known_is_passed_on(tmp_path: Path) -> None:
    info = device_info(8000.0, ["s1x", "s1y", "s1z", "s2x", "s2y", "s2z"])
    found = fields(reading_of(10, [0.0] * 6), info, str(tmp_path))
    assert (found["uptime_s"], found["last_seq"], found["connected"]) == (3.5, {"limb/raw": 7}, False)
    assert (found["q"], found["q_units"]) == ([0.5, -1.0], ["rad", "m"])
    assert found["device"]["rate_hz"] == 8000.0
    tracking = {"method": "filter", "innovation": 1.5, "jolts": 2, "doubted": 3, "wrong": True}
    assert found["tracking"] == tracking
    assert (found["recording"], found["recording_lost"]) == (None, 4)
    assert found["disk_free_bytes"] == pytest.approx(shutil.disk_usage(tmp_path).free, rel=0.1)
    assert fields(reading_of(10, [0.0] * 6), info)["disk_free_bytes"] is None
    assert fields(reading_of(10, [0.0] * 6), info, str(tmp_path / "gone"))["disk_free_bytes"] is None
    assert (found["samples"], found["lost_samples"], found["gaps"]) == (0, 0, {"causes": {}, "last": []})
    assert found["clock_ppm"] is None
    assert found["rate"]["claimed_hz"] == 8000.0


@pytest.mark.parametrize("ms", np.geomspace(0.15, 50_000.0, 60).tolist())
def test_a_percentile_of_the_run_is_rounded_up_by_two_percent_at_most(ms: float) -> None:
    latency = Latency()
    latency.note(1e-3 * ms)
    taken = latency.take()
    assert taken["p50"] == taken["p99"] == pytest.approx(ms)
    assert taken["p99_run"] is not None and ms <= taken["p99_run"] <= 1.0201 * ms


@pytest.mark.parametrize(("slow", "most_ms"), [(2, 1.02), (3, 103.0)])
def test_one_block_in_a_hundred_may_exceed_the_percentile(slow: int, most_ms: float) -> None:
    latency = Latency()
    for k in range(200):
        latency.note(0.1 if k < slow else 0.001)
        if k == 100:
            latency.take()
    p99 = latency.take()["p99_run"]
    assert p99 is not None and 0.97 * most_ms < p99 <= most_ms
