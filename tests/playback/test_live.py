"""A stream passed on: real sockets, a daemon's messages."""

from collections.abc import Iterator

import numpy as np
import pytest

from arm.arm_file import parse_arm
from limbcal.errors import ConfigError
from playback.control_message import Request
from playback.live import LivePlayer
from playback.server import Server
from protocol.message import FRAMES, HEALTH, PLAY
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS
from tests.playback.test_server import receive

FREE = "tcp://127.0.0.1:*"


def block(k: int, n_joint: int = 2) -> dict[str, object]:
    n = 10
    t = 0.01 * k + 0.001 * np.arange(n)
    rows = np.column_stack([np.sin(t + j) for j in range(n_joint)])
    return {
        "frame0": n * k,
        "t0_ns": 10**18 + 10_000_000 * k,
        "dt_s": 0.001,
        "n": n,
        "method": "filter",
        "q": rows,
        "dq": rows,
        "ddq": rows,
        "tip": np.zeros((n, 3)),
        "points": np.full((n, 4, 3), float(k)),
        "gap": k == 3,
    }


@pytest.fixture
def daemon(context) -> Iterator[Publisher]:
    with Publisher(context, FREE, "dd-arm", "run") as publisher:
        yield publisher


@pytest.fixture
def player(context, daemon: Publisher, arm) -> Iterator[LivePlayer]:
    with Subscriber(context, daemon.endpoint, [FRAMES]) as subscriber:
        assert daemon.socket.poll(PATIENCE_MS)  # it is subscribed
        assert daemon.joined()
        yield LivePlayer(subscriber, daemon.endpoint, arm)


def come(player: LivePlayer) -> dict[str, object] | None:
    assert player.waits_on.poll(PATIENCE_MS)
    return player.take_due()


def test_what_comes_is_passed_on_as_it_is(context, daemon: Publisher, player: LivePlayer, fake_time) -> None:
    with Server(context, player, fake_time.clocks, fake_time.sleep, FREE, FREE) as server:
        with Subscriber(context, server.endpoint, [PLAY, HEALTH]) as viewer:
            while viewer.receive(20) is None:
                fake_time.now_s += 1.0
                server.step()
            for k in range(5):
                daemon.publish(FRAMES, block(k))
            for _ in range(5):
                assert player.waits_on.poll(PATIENCE_MS)
                server.step()
            frames = [receive(viewer, PLAY) for _ in range(5)]
    for k, frame in enumerate(frames):
        sent = block(k)
        assert {name: frame[name] for name in ("frame0", "t0_ns", "n", "dt_s", "gap", "method")} == {
            name: sent[name] for name in ("frame0", "t0_ns", "n", "dt_s", "gap", "method")
        }
        for name in ("q", "dq", "ddq", "tip", "points"):
            np.testing.assert_array_equal(frame[name], sent[name])
        assert frame["source"] == f"live from {daemon.endpoint}"
        assert frame["position_s"] == pytest.approx(0.01 * k)


def test_a_pause_holds_frames_back_and_the_state_goes_on(daemon: Publisher, player: LivePlayer) -> None:
    player.carry_out(Request("pause"))
    daemon.publish(FRAMES, block(0))
    assert come(player) is None
    assert player.state()["q"] == pytest.approx(np.sin([0.009, 1.009]).tolist())
    assert player.state()["rate_hz"] == pytest.approx(1000.0)  # a frame each millisecond
    player.carry_out(Request("play"))
    daemon.publish(FRAMES, block(1))
    assert come(player)["frame0"] == 10


def test_what_is_not_as_agreed_is_counted_and_not_passed_on(
    context, daemon: Publisher, player: LivePlayer
) -> None:
    daemon.publish(FRAMES, block(0, n_joint=3))
    daemon.publish(FRAMES, {"t0_ns": 1})
    daemon.socket.send_multipart([FRAMES.encode(), b"\xc1"])
    assert [come(player) for _ in range(3)] == [None] * 3
    assert player.state()["refused"] == 3


def test_it_says_what_moves_and_what_it_cannot_do(player: LivePlayer, arm) -> None:
    assert parse_arm(player.carry_out(Request("arm"))["arm"], "reply") == arm
    for cmd, value in (("seek", 1.0), ("speed", 2.0), ("step", 1), ("loop", True), ("load", 1), ("motion", None)):
        with pytest.raises(ConfigError, match=f"{cmd} is for a stored motion, and this is live"):
            player.carry_out(Request(cmd, value))


def test_a_daemon_is_served_by_the_command(context, daemon: Publisher, start) -> None:
    with start("--live", daemon.endpoint, "--arm", "dd-arm") as running:
        assert daemon.socket.poll(PATIENCE_MS)
        state = running.ask("state")["state"]
        assert (state["live"], state["playing"]) == (True, True)
        with Subscriber(context, running.endpoint, [PLAY, HEALTH]) as viewer:
            receive(viewer, HEALTH)
            daemon.publish(FRAMES, block(2))
            assert receive(viewer, PLAY)["frame0"] == 20
        reply = running.ask("seek", 1.0)
        assert reply["ok"] is False


def test_before_anything_came_it_is_known_to_be_live(player: LivePlayer, daemon: Publisher) -> None:
    name = f"live from {daemon.endpoint}"
    assert player.state() == {
        **{"playing": True, "trial": 0, "position_s": 0.0, "duration_s": None, "rate_hz": None, "speed": 1.0},
        **{"loop": False, "source": name, "arm": "dd-arm", "twin": False, "live": True, "q": None},
        **{"trials": [], "finished": 0, "refused": 0, "missed": 0},
    }
    assert (player.name, player.finished, player.deadline_s()) == (name, 0, None)
    assert player.take_due() is None
    assert player.carry_out(Request("list")) == {"trials": []}
    assert player.carry_out(Request("arm"))["twin"] is None
    for cmd, playing in (("stop", False), ("play", True), ("pause", False), ("state", False)):
        assert player.carry_out(Request(cmd)) == {} and player.playing is playing
    player.play()
    assert player.playing is True


def test_a_frame_is_counted_from_the_first_that_came(daemon: Publisher, player: LivePlayer) -> None:
    daemon.publish(FRAMES, {**block(7), "mine": 1})
    frame = come(player)
    assert frame is not None and frame["position_s"] == 0.0
    assert {name: frame[name] for name in ("speed", "trial", "source")} == {
        "speed": 1.0,
        "trial": 0,
        "source": player.name,
    }
    assert "mine" not in frame
    daemon.publish(FRAMES, block(9))
    frame = come(player)
    assert frame is not None and frame["position_s"] == pytest.approx(0.02)
    assert player.state()["position_s"] == pytest.approx(0.02)


@pytest.mark.parametrize(
    "name", ["frame0", "t0_ns", "dt_s", "n", "method", "q", "dq", "ddq", "tip", "points", "gap"]
)
def test_each_field_of_a_frame_is_needed(daemon: Publisher, player: LivePlayer, name: str) -> None:
    fields = block(0)
    del fields[name]
    daemon.publish(FRAMES, fields)
    assert come(player) is None and player.refused == 1
    daemon.publish(FRAMES, {**block(0), "q": 5})
    assert come(player) is None and player.refused == 2


@pytest.mark.parametrize(
    "wrong",
    [
        {"n": 0, **{name: np.zeros((0, 2)) for name in ("q", "dq", "ddq")}},
        {"n": 0, "q": np.zeros((0, 2)), "dq": np.zeros((0, 2)), "ddq": np.zeros((0, 2)),
         "tip": np.zeros((0, 3)), "points": np.zeros((0, 4, 3))},
        {"n": 500}, {"n": -10}, {"n": 10.0}, {"n": None},
        {"dt_s": 0.0}, {"dt_s": -0.001}, {"dt_s": "x"}, {"dt_s": None}, {"dt_s": float("nan")},
        {"dt_s": float("inf")}, {"dt_s": 1e-320}, {"dt_s": 1e300},
        {"t0_ns": None}, {"t0_ns": 1e18}, {"t0_ns": "now"}, {"frame0": None}, {"frame0": 0.5},
        {"q": None}, {"dq": None}, {"ddq": [[0.0, 0.0]] * 10}, {"dq": np.zeros((3, 2))}, {"ddq": np.zeros(20)},
        {"tip": np.zeros((10, 2))}, {"tip": None}, {"points": np.zeros((10, 3))}, {"points": np.zeros((9, 4, 3))},
        {"gap": None}, {"method": 7},
    ],
)  # fmt: skip
def test_a_block_that_is_not_as_agreed_ends_nothing(
    context, daemon: Publisher, player: LivePlayer, fake_time, wrong: dict[str, object]
) -> None:
    with Server(context, player, fake_time.clocks, fake_time.sleep, FREE, FREE) as server:
        for k, fields in enumerate(({**block(0), **wrong}, block(1))):
            daemon.publish(FRAMES, fields)
            assert player.waits_on.poll(PATIENCE_MS)
            server.step()
            assert server.state()["refused"] == 1
            assert (server.state()["rate_hz"] is None) is (k == 0)
