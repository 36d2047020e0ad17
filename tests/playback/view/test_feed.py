"""What a page keeps of a stream: the newest frame, and the motion behind it as long as it was one motion."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import zmq

from playback.view.feed import HISTORY, JUMP_S, SPACING_S, Feed, Picture
from protocol.message import FRAMES, PLAY
from protocol.publisher import Publisher
from tests.playback.view.conftest import eventually

DT_S = 0.01


def frames(begin_s: float, n: int = 5, **more: Any) -> dict[str, Any]:
    at = begin_s + DT_S * np.arange(n)
    q = np.column_stack([at, 2.0 * at])
    fields = {"position_s": begin_s, "dt_s": DT_S, "q": q, "tip": np.column_stack([at, at, at]), "trial": 1}
    return fields | {"speed": 1.0, "source": "file"} | more


class Stream:
    """A publisher and the feed that follows it."""

    def __init__(self, publisher: Publisher, feed: Feed) -> None:
        self.publisher, self.feed = publisher, feed

    def say(self, fields: dict[str, Any], topic: str = PLAY) -> Picture:
        """Publish, and return the picture that comes of it."""
        count = 0 if (last := self.feed.newest()) is None else last.count
        self.publisher.publish(topic, fields)
        found = eventually(lambda: p if (p := self.feed.newest()) and p.count > count else None, "a picture")
        assert isinstance(found, Picture)
        return found

    def places(self, span_s: float = 1e9) -> list[float]:
        return [round(row.position_s, 6) for row in self.feed.history(span_s)]


@pytest.fixture
def stream(context: zmq.Context[zmq.Socket[bytes]]) -> Iterator[Stream]:
    with Publisher(context, "tcp://127.0.0.1:*", "dd-arm", "run 1") as publisher:
        feed = Feed(context, publisher.endpoint)
        try:
            one = Stream(publisher, feed)

            def heard() -> bool:
                publisher.publish(PLAY, frames(-1000.0, 1))
                return feed.newest() is not None

            eventually(heard, "a stream that is heard")
            one.say(frames(0.0, 1))
            yield one
        finally:
            feed.close()


def test_the_newest_is_the_last_of_a_message(stream: Stream) -> None:
    before = stream.feed.newest()
    assert before is not None
    picture = stream.say(frames(0.01))
    assert picture.count == before.count + 1
    assert picture.jumps == before.jumps
    assert (picture.topic, picture.source, picture.speed) == (PLAY, "file", 1.0)
    assert picture.row.position_s == pytest.approx(0.05)
    assert picture.row.real.q == pytest.approx([0.05, 0.1])
    assert picture.row.real.tip == pytest.approx([0.05] * 3)
    assert picture.row.twin is None


def test_what_was_before_is_kept_as_long_as_it_is_asked_for(stream: Stream) -> None:
    for k in range(4):
        stream.say(frames(0.01 + 0.05 * k))
    assert stream.places() == pytest.approx([DT_S * k for k in range(21)])
    assert stream.places(0.1001) == pytest.approx([DT_S * k for k in range(10, 21)])


def test_frames_that_follow_too_close_are_left_out(stream: Stream) -> None:
    stream.say(frames(0.002, 50, dt_s=0.002))
    assert np.diff(stream.places()).min() >= SPACING_S
    assert len(stream.places()) >= 0.1 / 0.011


def test_a_slow_playback_takes_longer_for_the_same_way(stream: Stream) -> None:
    assert stream.say(frames(0.01, speed=3.0)).row.position_s == pytest.approx(0.01 + 4 * 3.0 * DT_S)


@pytest.mark.parametrize(
    ("begin_s", "more", "jumps"),
    [
        (0.01, {}, False),
        (-0.5 * SPACING_S, {}, False),
        (-1.5 * SPACING_S, {}, True),
        (0.9 * JUMP_S, {}, False),
        (1.1 * JUMP_S, {}, True),
        (0.01, {"trial": 2}, True),
        (0.01, {"q": np.zeros((5, 3))}, True),
    ],
)
def test_what_breaks_off_is_no_past(stream: Stream, begin_s: float, more: dict[str, Any], jumps: bool) -> None:
    before = stream.feed.newest()
    assert before is not None
    assert stream.say(frames(begin_s, **more)).jumps == before.jumps + jumps
    assert (0.0 in stream.places()) != jumps


def test_a_fast_playback_leaps_further(stream: Stream) -> None:
    before = stream.say(frames(0.01, speed=4.0)).jumps
    assert stream.say(frames(0.13 + 3.5 * JUMP_S, speed=4.0)).jumps == before


def test_a_twin_goes_beside(stream: Stream) -> None:
    twin = {"q": np.ones((5, 2)), "tip": np.full((5, 3), 2.0)}
    row = stream.say(frames(0.01, twin=twin)).row
    assert row.twin is not None
    assert row.twin.q == pytest.approx([1.0, 1.0])
    assert row.twin.tip == pytest.approx([2.0, 2.0, 2.0])


def test_without_a_place_the_number_of_the_frame_tells_it(stream: Stream) -> None:
    fields = frames(0.0) | {"frame0": 7}
    del fields["position_s"]
    assert stream.say(fields).row.position_s == pytest.approx((7 + 4) * DT_S)


def test_live_time_counts_from_the_first_frame(stream: Stream) -> None:
    fields = frames(0.0, method="kalman")
    del fields["position_s"], fields["source"], fields["speed"]
    first = stream.say(fields | {"t0_ns": 5_000_000_000}, FRAMES)
    assert (first.row.position_s, first.source, first.speed) == (pytest.approx(0.04), "kalman", 1.0)
    assert stream.say(fields | {"t0_ns": 5_100_000_000}, FRAMES).row.position_s == pytest.approx(0.14)
    again = stream.say(fields | {"t0_ns": 1_000_000_000}, FRAMES)  # somebody begins anew
    assert again.row.position_s == pytest.approx(0.04)


@pytest.mark.parametrize(
    "wrong",
    [
        {"q": np.zeros(5)},
        {"q": np.zeros((0, 2)), "tip": np.zeros((0, 3))},
        {"tip": np.zeros((4, 3))},
        {"tip": np.zeros((5, 2))},
        {"q": np.full((5, 2), np.nan)},
        {"tip": np.full((5, 3), np.inf)},
        {"dt_s": "fast"},
        {"twin": {"q": np.zeros((4, 2)), "tip": np.zeros((4, 3))}},
    ],
)
def test_what_is_no_motion_is_counted_and_passed_over(stream: Stream, wrong: dict[str, Any]) -> None:
    stream.publisher.publish(PLAY, frames(0.01) | wrong)
    eventually(lambda: stream.feed.broken == 1, "a message that is counted")
    assert stream.say(frames(0.01)).row.position_s == pytest.approx(0.05)


def test_the_past_has_an_end(stream: Stream) -> None:
    stream.say(frames(0.01, HISTORY + 100))
    places = stream.places()
    assert len(places) == HISTORY
    assert places[-1] == pytest.approx((HISTORY + 100) * DT_S)
