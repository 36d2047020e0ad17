"""The server on real sockets, by a clock that the test moves."""

from collections.abc import Iterator

import numpy as np
import pytest

from limbcal.errors import DeviceError
from playback.player import Player
from playback.server import Server
from protocol.message import HEALTH, PLAY, PLOT
from protocol.subscriber import Subscriber
from tests.playback.heard import receive


@pytest.fixture
def server(context, source, fake_time) -> Iterator[Server]:
    player = Player(source, 100.0, fake_time.clocks)
    free = "tcp://127.0.0.1:*"
    with Server(context, player, fake_time.clocks, fake_time.sleep, free, free) as server:
        yield server


@pytest.fixture
def subscriber(context, server: Server, fake_time) -> Iterator[Subscriber]:
    """Return a subscriber that the server's messages already reach."""
    with Subscriber(context, server.endpoint, [PLAY, HEALTH]) as subscriber:
        while subscriber.receive(20) is None:
            fake_time.now_s += 1.0
            server.step()
        while subscriber.receive(20) is not None:
            pass
        yield subscriber


def test_each_frame_leaves_on_its_deadline(server: Server, subscriber: Subscriber, fake_time) -> None:
    server.player.play()
    frames = []
    while server.player.playing:
        fake_time.now_s = server.player.deadline_s() + 2e-4
        server.step()
        frames.append(receive(subscriber, PLAY))
    assert np.diff([frame["t0_ns"] for frame in frames]).tolist() == [10_000_000] * 50
    assert [frame["seq"] for frame in frames] == list(range(51))
    motion = server.player.source.load()
    q = np.concatenate([frame["q"] for frame in frames])
    np.testing.assert_array_equal(q, motion.at(np.arange(51) / 100.0)[0])
    late = server.state()["lateness_ms"]
    assert late == pytest.approx({"p50": 0.2, "p99": 0.2, "max": 0.2}, abs=1e-6)


def test_a_hold_up_delays_no_later_frame_and_loses_none(server: Server, subscriber: Subscriber, fake_time) -> None:
    server.player.play()
    start_s = fake_time.now_s
    fake_time.now_s += 0.105
    frames = []
    while server.player.playing:
        server.step()
        frames.append(receive(subscriber, PLAY))
        fake_time.now_s = max(fake_time.now_s, server.player.deadline_s() or 0.0)
    assert fake_time.now_s == pytest.approx(start_s + 0.5)
    assert np.diff([frame["t0_ns"] for frame in frames]).tolist() == [10_000_000] * 50
    assert server.state()["lateness_ms"]["max"] == pytest.approx(105.0)


def test_the_heartbeat_comes_once_a_second_and_says_what_was_sent(
    server: Server, subscriber: Subscriber, fake_time
) -> None:
    server.player.play()
    for _ in range(3 * 128):
        fake_time.now_s += 1 / 128
        server.step()
    fake_time.now_s += 7.0  # held up: one heartbeat makes up for all that were missed
    server.step()
    server.step()
    fake_time.now_s += 1.0
    server.step()
    health = []
    while (message := subscriber.receive(200)) is not None:
        if message[0] == HEALTH:
            health.append(message[1])
    assert [beat["uptime_s"] - health[0]["uptime_s"] for beat in health] == [0.0, 1.0, 2.0, 9.0, 10.0]
    assert health[0].keys() >= {"uptime_s", "last_seq", "playing", "lateness_ms", "arm", "run", "seq", "v"}
    assert health[-1]["last_seq"] == {PLAY: 50, PLOT: 50, HEALTH: health[-1]["seq"] - 1}
    assert not subscriber.missed


def test_between_deadlines_it_waits_neither_less_nor_more(server: Server, fake_time) -> None:
    start_s = fake_time.now_s
    polled: list[int] = []
    server._poller.poll = lambda whole_ms: polled.append(whole_ms) or []  # type: ignore[method-assign]
    server.player.play()
    server.serve(once=True)
    assert fake_time.now_s == pytest.approx(start_s + 0.5)
    assert len(fake_time.slept) == 50
    assert polled == [int(1e3 * seconds) for seconds in fake_time.slept]  # whole milliseconds, then the rest


def test_a_taken_endpoint_is_said_and_nothing_stays_bound(context, source, fake_time, server: Server) -> None:
    player = Player(source, 100.0, fake_time.clocks)
    arguments = (context, player, fake_time.clocks, fake_time.sleep)
    with pytest.raises(DeviceError, match=f"{server.control} is already taken"):
        Server(*arguments, "tcp://127.0.0.1:*", server.control)
    with pytest.raises(DeviceError, match=f"{server.endpoint} is already taken"):
        Server(*arguments, server.endpoint, "tcp://127.0.0.1:*")


def test_whoever_comes_late_is_told_the_state_at_once(context, server: Server, fake_time) -> None:
    server.player.play()
    fake_time.now_s += 0.2
    while server.player.deadline_s() <= fake_time.now_s:
        server.step()
    for _ in range(2):  # a second one to the same topic too
        with Subscriber(context, server.endpoint, [HEALTH]) as late:
            while (message := late.receive(20)) is None:
                server.step()
            state = message[1]["state"]
            assert (state["playing"], state["position_s"]) == (True, pytest.approx(0.2))
            assert state["q"] == server.player.source.load().at(np.array([state["position_s"]]))[0][0].tolist()


def test_plotting_programs_get_rows(context, server: Server, fake_time) -> None:
    with Subscriber(context, server.endpoint, [PLOT, HEALTH]) as subscriber:
        while subscriber.receive(20) is None:
            fake_time.now_s += 1.0
            server.step()
        server.player.play()
        for _ in range(3):
            server.step()
            fake_time.now_s += 0.01
        rows = [receive(subscriber, PLOT)["rows"] for _ in range(3)]
    q = server.player.source.load().at(np.arange(3) / 100.0)[0]
    assert [[row["q1"], row["q2"]] for (row,) in rows] == q.tolist()
    assert np.diff([row["ts"] for (row,) in rows]).tolist() == pytest.approx([0.01, 0.01], abs=1e-6)


def test_unless_asked_to_it_does_not_end_with_the_trial(server: Server, fake_time) -> None:
    server.player.play()
    waits = 0

    def wait(seconds: float) -> None:
        nonlocal waits
        fake_time.sleep(max(seconds, 1e-3))
        waits += server.player.finished
        if waits > 3:
            raise KeyboardInterrupt

    server._sleep = wait
    server._poller.poll = lambda _ms: []
    with pytest.raises(KeyboardInterrupt):
        server.serve()
    assert server.player.finished
    server.serve(once=True)
