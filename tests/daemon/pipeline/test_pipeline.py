"""From chunks of bytes to published motion, with a real publisher and who hears it."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq

from arm.arm_file import load_arm
from daemon.acquisition.ring import Chunk, Mark
from daemon.clock.host_clock import HostClock
from daemon.config.config import Setup, load_setup
from daemon.pipeline.pipeline import Pipeline, tracker_for
from daemon.reception.reception import Reception
from limbcal.errors import ConfigError
from protocol.device_info import DeviceInfo
from protocol.message import FRAMES, GAP, HEALTH, RAW
from protocol.publisher import Publisher
from protocol.serial_frame import InfoFrame, encode_samples
from protocol.serial_parser import FrameParser
from protocol.subscriber import Subscriber
from tests.daemon.conftest import device_info, resting_counts
from tests.patience import PATIENCE_MS

RATE_HZ, TICK_HZ, FRAME = 8000.0, 1_000_000, 32
TICKS = round(FRAME / RATE_HZ * TICK_HZ)


def setup_of(*, raw: bool = False, **tracking: object) -> Setup:
    tables = {
        **{"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}, "publish": {"raw": raw}},
        **{"tracking": {"initial_q_rad": [0.0, 0.0], **tracking}},
    }
    return load_setup(None, tables)


class Room:
    """A pipeline, the reception that it empties and a subscriber."""

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", folder: Path, setup: Setup, info: DeviceInfo
    ) -> None:
        self.ahead_ns = 0  # by how much the host's clock was set
        host = HostClock(lambda: time.time_ns() + self.ahead_ns)
        self.reception = Reception(FrameParser(), InfoFrame(0, 0, info), host)
        self.publisher = Publisher(context, f"ipc://{folder}/frames", "dd-arm", "run-1")
        self.subscriber = Subscriber(context, self.publisher.endpoint, [FRAMES, RAW, GAP, HEALTH, "probe"])
        self.pipeline = Pipeline(setup, "run-1", self.reception, self.publisher, None)
        self.sent = 0
        while self.subscriber.receive(20) is None:
            self.publisher.attend()
            self.publisher.publish("probe", {})
        self.heard()

    def bytes_of(self, n_frame: int, counts: np.ndarray, lost: int = 0) -> bytes:
        self.sent += lost
        out = b""
        for _ in range(n_frame):
            out += encode_samples(counts, self.sent + 1, 50 + self.sent * TICKS)
            self.sent += 1
        return out

    def play(self, n_frame: int, counts: np.ndarray, lost: int = 0) -> None:
        """Hand frames over at once; they are as old as their samples."""
        self.pipeline.accept([Chunk(time.monotonic_ns(), self.bytes_of(n_frame, counts, lost))])

    def heard(self) -> dict[str, list[dict[str, Any]]]:
        """Return what was published until now, by topic."""
        found: dict[str, list[dict[str, Any]]] = {}
        self.publisher.publish("probe", {"last": True})
        while True:
            message = self.subscriber.receive(PATIENCE_MS)
            assert message is not None
            topic, fields = message
            if topic == "probe" and fields.get("last"):
                return found
            found.setdefault(topic, []).append(fields)

    def close(self) -> None:
        self.subscriber.close()
        self.publisher.close()


Make = Callable[..., Room]


@pytest.fixture
def room(
    tmp_path: Path,
) -> Iterator[Make]:
    made: list[Room] = []
    with zmq.Context() as context:

        def make(setup: Setup | None = None, rate_hz: float = RATE_HZ) -> Room:
            made.append(Room(context, tmp_path, setup or setup_of(), device_info(rate_hz)))
            return made[-1]

        yield make
        for one in made:
            one.close()


@pytest.fixture
def counts() -> np.ndarray:
    return resting_counts(FRAME)


def samples_of(frames: list[dict[str, Any]]) -> int:
    return sum(len(block["q"]) for block in frames)


def test_samples_wait_until_the_rate_is_known_and_none_is_lost(
    room: Make, counts: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = room(setup_of(raw=True))
    here.play(10, counts)
    assert here.heard() == {} and not here.pipeline.streaming
    now_ns = time.monotonic_ns()
    monkeypatch.setattr(time, "monotonic_ns", lambda: now_ns + 300_000_000)
    here.play(50, counts)
    here.pipeline.finish()
    heard = here.heard()
    raw = np.concatenate([block["a"] for block in heard[RAW]])
    expected = np.tile(counts * here.reception.info.channels[0].scale, (60, 1))
    np.testing.assert_allclose(raw, expected, atol=1e-9)
    assert [block["sample0"] for block in heard[RAW]] == np.cumsum(
        [0, *(b["n"] for b in heard[RAW][:-1])]
    ).tolist()
    assert here.pipeline.streaming
    assert samples_of(heard[FRAMES]) == pytest.approx(60 * FRAME / RATE_HZ * 1000.0, abs=2)  # frames at 1 kHz


def test_where_nothing_was_sampled_yet_the_rate_is_what_the_device_says(
    room: Make, counts: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = room(setup_of(raw=True))
    monkeypatch.setattr(here.reception, "knows_rate", lambda _now_ns: True)
    here.pipeline.accept([])
    here.play(60, counts)
    here.pipeline.finish()
    heard = here.heard()
    assert samples_of(heard[FRAMES]) == pytest.approx(60 * FRAME / RATE_HZ * 1000.0, abs=2)
    assert heard[RAW][0]["n"] > FRAME // 2


def test_raw_samples_are_published_where_asked_for(room: Make, counts: np.ndarray) -> None:
    here = room()
    here.play(60, counts)
    here.pipeline.finish()
    heard = here.heard()
    assert FRAMES in heard and RAW not in heard
    assert {block["method"] for block in heard[FRAMES]} == {"filter"}


def test_before_frames_are_sent_or_after_the_line_is_cut_nothing_streams(room: Make, counts: np.ndarray) -> None:
    here = room()
    assert not here.pipeline.streaming and not here.pipeline.awaits_info
    here.play(100, counts)
    here.pipeline.finish()
    assert here.pipeline.streaming
    here.pipeline.accept([Chunk(time.monotonic_ns(), b"", Mark.LOST)])
    assert not here.pipeline.streaming


def test_lost_samples_are_told_and_bridged(room: Make, counts: np.ndarray) -> None:
    here = room()
    here.play(100, counts)
    here.play(100, counts, lost=3)
    here.pipeline.finish()
    heard = here.heard()
    (gap,) = heard[GAP]
    assert (gap["samples"], gap["sample0"], gap["exact"]) == (3 * FRAME, 100 * FRAME, True)
    bridge = [block for block in heard[FRAMES] if block["gap"]]
    assert 12 <= samples_of(bridge) <= 24  # 12 ms, and what of a block was not full
    assert samples_of(heard[FRAMES]) == pytest.approx(203 * FRAME / RATE_HZ * 1000.0, abs=3)
    at = np.cumsum([0, *(len(block["q"]) for block in heard[FRAMES])])
    assert [block["frame0"] - heard[FRAMES][0]["frame0"] for block in heard[FRAMES]] == at[:-1].tolist()


def test_chunks_that_found_no_room_are_accounted_for_once(room: Make, counts: np.ndarray) -> None:
    here = room()
    here.play(100, counts)
    here.pipeline.accept([], dropped=2)
    here.pipeline.accept([], dropped=2)
    here.pipeline.accept([Chunk(time.monotonic_ns(), here.bytes_of(100, counts, lost=5))], dropped=2)
    here.pipeline.finish()
    (gap,) = here.heard()[GAP]
    assert (gap["samples"], gap["why"]) == (5 * FRAME, "the daemon fell behind")
    here.play(100, counts, lost=1)
    here.pipeline.finish()
    assert [one["why"] for one in here.heard()[GAP]] != ["the daemon fell behind"]
    assert here.reception.ledger.lost_samples == 6 * FRAME


def test_health_says_where_the_arm_is_and_how_it_is_doing(room: Make, counts: np.ndarray) -> None:
    here = room()
    first = here.pipeline.report(connected=True)
    assert first["q"] is None and first["samples"] == 0
    here.play(200, counts)
    here.pipeline.finish()
    health = here.pipeline.report(connected=True)
    (*_, published) = here.heard()[HEALTH]
    assert health["connected"] is True and published["samples"] == 200 * FRAME
    assert published["recording"] is None
    assert np.abs(health["q"]).max() < 0.2  # at rest where it began
    off = [here.pipeline.report(connected=False) for _ in range(5)]
    assert off[-1]["connected"] is False
    words = [word for one in off for word in one["words"]]
    assert len(words) == 1 and words[0].startswith("alarm: ") and "there is no device" in words[0]
    assert [alarm["name"] for alarm in off[-1]["alarms"]] == ["disconnected"]
    on = [here.pipeline.report(connected=True) for _ in range(30)]
    assert [word for one in on for word in one["words"]] == ["over: disconnected "]


def test_a_clock_that_is_set_is_told_as_a_gap_without_loss(room: Make, counts: np.ndarray) -> None:
    here = room()
    here.play(100, counts)
    here.pipeline.finish()
    here.heard()
    here.ahead_ns = 3_000_000_000
    here.pipeline.report(connected=True)
    here.pipeline.report(connected=True)
    (gap,) = here.heard()[GAP]
    assert (gap["samples"], gap["sample0"], gap["exact"]) == (0, 100 * FRAME, True)
    assert gap["why"] == "the host's clock was set by +3.000 s"
    assert here.reception.ledger.lost_samples == 0


@pytest.mark.parametrize(("method", "said"), [("filter", "filter"), ("integrate", "integrate")])
def test_the_tracker_is_the_config_s(method: str, said: str) -> None:
    assert tracker_for(setup_of(method=method), RATE_HZ).method == said


def test_sensors_that_cannot_be_tracked_are_a_mistake_of_the_config() -> None:
    setup = setup_of()
    bare = Setup(setup.config, load_arm("dd-arm").__class__("bare", setup.arm.joints))
    with pytest.raises(ConfigError, match="sensor"):
        tracker_for(bare, RATE_HZ)


def test_a_tracker_goes_on_by_a_rate_that_has_changed(
    room: Make, counts: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, rates = room(), list[float]()
    here.play(10, counts)
    now_ns = time.monotonic_ns()
    monkeypatch.setattr(time, "monotonic_ns", lambda: now_ns + 300_000_000)
    monkeypatch.setattr(here.reception.rate, "dt_s", lambda _ticks: 1.0 / RATE_HZ)
    here.play(50, counts)
    tracker = here.pipeline._tracker  # the one that begins when the rate is known
    monkeypatch.setattr(tracker, "retime", rates.append)
    for rate_hz in (RATE_HZ, 7680.0, 7680.0, 8040.0):
        monkeypatch.setattr(here.reception.rate, "dt_s", lambda _ticks, rate_hz=rate_hz: 1.0 / rate_hz)
        here.play(50, counts)
    here.pipeline.finish()
    assert rates == pytest.approx([7680.0, 8040.0])
