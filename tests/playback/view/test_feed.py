"""What the page keeps of a stream: the newest frame, and the motion behind it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq

from playback.view.feed import Feed, Picture
from protocol.message import FRAMES, PLAY
from protocol.publisher import Publisher
from tests.playback.view.conftest import eventually


class Room:
    """A publisher and the feed that follows it."""

    def __init__(self, context: "zmq.Context[zmq.Socket[bytes]]", folder: Path) -> None:
        self.publisher = Publisher(context, f"ipc://{folder}/play", "dd-arm", "run", watched=True)
        self.feed = Feed(context, self.publisher.endpoint)
        eventually(self.publisher.joined, "a subscription", 30.0)
        self.publisher.publish(PLAY, {})
        eventually(lambda: self.feed.broken == 1, "a message was heard", 30.0)

    def send(self, topic: str = PLAY, n: int = 1, **fields: Any) -> Picture:
        """Publish a frame at a place, and return the picture of it."""
        base = {"q": np.full((n, 2), 0.5), "tip": np.zeros((n, 3)), "dt_s": 0.01, "trial": 1, "speed": 1.0}
        before = self.feed.newest()
        count = 0 if before is None else before.count
        self.publisher.publish(topic, {k: v for k, v in {**base, **fields}.items() if v is not None})
        eventually(lambda: (one := self.feed.newest()) is not None and one.count == count + 1, "a picture", 30.0)
        picture = self.feed.newest()
        assert picture is not None
        return picture

    def places(self, span_s: float = 100.0) -> list[float]:
        return [row.position_s for row in self.feed.history(span_s)]


@pytest.fixture
def room(tmp_path: Path) -> Iterator[Room]:
    with zmq.Context() as context:
        made = Room(context, tmp_path)
        yield made
        made.feed.close()
        made.publisher.close()


def test_before_the_first_frame_there_is_nothing(room: Room) -> None:
    assert room.feed.newest() is None and room.feed.history(10.0) == []
    first = room.send(position_s=3.0)
    assert (first.count, first.jumps) == (1, 0)


def test_a_picture_is_the_newest_frame_of_its_message(room: Room) -> None:
    q, tip = np.arange(6.0).reshape(3, 2), np.arange(9.0).reshape(3, 3)
    twin = {"q": -q, "tip": -tip}
    picture = room.send(n=3, q=q, tip=tip, twin=twin, position_s=1.0, speed=2.0, source="day.mcap")
    assert picture.row.position_s == pytest.approx(1.0 + 2 * 0.01 * 2.0)
    assert picture.row.real.q.tolist() == [4.0, 5.0] and picture.row.real.tip.tolist() == [6.0, 7.0, 8.0]
    assert picture.row.twin is not None
    assert picture.row.twin.q.tolist() == [-4.0, -5.0] and picture.row.twin.tip.tolist() == [-6.0, -7.0, -8.0]
    assert (picture.topic, picture.source, picture.speed) == (PLAY, "day.mcap", 2.0)
    assert room.places() == pytest.approx([1.0, 1.02, 1.04])
    assert [row.real.q[0] for row in room.feed.history(100.0)] == [0.0, 2.0, 4.0]


def test_a_frame_without_a_twin_has_none(room: Room) -> None:
    assert room.send(position_s=0.0, twin=None).row.twin is None
    picture = room.send(position_s=0.01, source=None, method="filter", speed=None)
    assert (picture.source, picture.speed) == ("filter", 1.0)


def test_without_a_place_it_is_the_frame_s_number_times_its_step(room: Room) -> None:
    assert room.send(frame0=250, dt_s=0.02).row.position_s == pytest.approx(5.0)


def test_what_is_live_begins_at_its_first_frame(room: Room) -> None:
    t0_ns = 1_700_000_000_000_000_000
    places = [room.send(FRAMES, t0_ns=t0_ns + k * 10_000_000).row.position_s for k in range(3)]
    assert places == pytest.approx([0.0, 0.01, 0.02])
    earlier = room.send(FRAMES, t0_ns=t0_ns - 10**9)  # the host's clock was set back
    assert (earlier.row.position_s, earlier.jumps) == (0.0, 0 + 1)


def test_only_frames_that_are_apart_are_kept(room: Room) -> None:
    for k in range(10):
        room.send(position_s=0.004 * k)
    assert room.places() == pytest.approx([0.0, 0.012, 0.024, 0.036])
    room.send(position_s=0.046)
    assert room.places()[-1] == pytest.approx(0.046)  # a hundredth of a second


def test_the_past_is_as_long_as_asked_for(room: Room) -> None:
    room.send(n=100, position_s=0.0)
    assert room.places(0.2) == pytest.approx(np.arange(79, 100) * 0.01)
    assert len(room.places(0.0)) == 1


@pytest.mark.parametrize(
    ("change", "jumps"),
    [
        ({"position_s": 1.29}, 0),
        ({"position_s": 1.31}, 1),
        ({"position_s": 0.995}, 0),  # a frame that came twice is none
        ({"position_s": 0.98}, 1),
        ({"trial": 2, "position_s": 1.01}, 1),
        ({"q": np.zeros((1, 3)), "position_s": 1.01}, 1),
    ],
)
def test_a_motion_that_breaks_off_is_forgotten(room: Room, change: dict[str, Any], jumps: int) -> None:
    room.send(position_s=0.99)
    room.send(position_s=1.0)
    picture = room.send(**change)
    assert picture.jumps == jumps
    assert (room.places()[0] == 0.99) == (jumps == 0)
    again = room.send(
        position_s=picture.row.position_s + 0.01, **{k: v for k, v in change.items() if k != "position_s"}
    )
    assert (again.jumps, again.count) == (jumps, 4)


@pytest.mark.parametrize(("speed", "jumps"), [(10.0, 0), (0.1, 1)])
def test_fast_it_may_go_further_between_two_frames(room: Room, speed: float, jumps: int) -> None:
    room.send(position_s=0.0, speed=speed)
    assert room.send(position_s=1.0, speed=speed).jumps == jumps
    assert room.send(position_s=1.0 + 0.2, speed=speed).jumps == jumps  # slow, it may go as far as at its own


def test_a_message_of_several_frames_follows_by_its_first(room: Room) -> None:
    room.send(position_s=1.0)
    picture = room.send(n=50, position_s=1.01)  # its last is half a second on
    assert (picture.row.position_s, picture.jumps) == (pytest.approx(1.5), 0)
    assert len(room.places()) == 51
    assert room.send(n=50, position_s=1.7).jumps == 0  # two tenths after the last of those before
    assert room.send(n=50, position_s=2.1).jumps == 1  # its first is back among them


@pytest.mark.parametrize(
    "broken",
    [
        {"q": None},
        {"q": np.zeros(2)},
        {"q": np.zeros((0, 2)), "tip": np.zeros((0, 3))},
        {"q": np.zeros((1, 2, 1))},
        {"tip": np.zeros((2, 3))},
        {"tip": np.zeros((1, 2))},
        {"q": np.full((1, 2), np.nan)},
        {"tip": np.full((1, 3), np.inf)},
        {"twin": {"q": np.zeros((2, 2)), "tip": np.zeros((2, 3))}},
        {"dt_s": "fast"},
    ],
)
def test_somebody_else_s_mistake_is_counted_and_passed_over(room: Room, broken: dict[str, Any]) -> None:
    room.send(position_s=0.0)
    before = room.feed.broken
    base = {"q": np.zeros((1, 2)), "tip": np.zeros((1, 3)), "dt_s": 0.01, "trial": 1, "position_s": 0.01}
    room.publisher.publish(PLAY, {k: v for k, v in {**base, **broken}.items() if v is not None})
    eventually(lambda: room.feed.broken == before + 1, "a mistake was counted", 30.0)
    picture = room.send(position_s=0.02)
    assert (picture.count, picture.jumps) == (2, 0)
