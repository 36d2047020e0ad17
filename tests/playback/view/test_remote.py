"""A page's line to a playback: what is wanted is asked for, and the newest state is kept."""

import threading
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import zmq

from playback.control_message import Request, decode_request, encode_refusal, encode_reply
from playback.view.remote import Motion, Remote
from tests.playback.view.conftest import eventually

Context = zmq.Context[zmq.Socket[bytes]]
MOTION: Mapping[str, Any] = {"t": [0.0, 1.0], "q": [[0.0, 1.0], [2.0, 3.0]], "tip": [[0.0] * 3, [1.0] * 3]}


class Playback:
    """Answers what is asked as a playback does, and notes it."""

    def __init__(self, context: Context) -> None:
        self.asked: list[tuple[str, object]] = []
        self.state: dict[str, Any] = {"run": "a", "trial": 1, "source": "file", "position_s": 0.5}
        self.motion: dict[str, Any] = {"motion": MOTION}
        self.refused = ""
        self.garbled = False
        self.held = threading.Event()
        self.held.set()
        self.over = threading.Event()
        self._socket = context.socket(zmq.REP)
        self._socket.bind("tcp://127.0.0.1:*")
        self.endpoint = self._socket.get(zmq.LAST_ENDPOINT).decode()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def close(self) -> None:
        self.held.set()
        self.over.set()
        self._thread.join()
        self._socket.close(0)

    def wishes(self) -> list[tuple[str, object]]:
        """Return what somebody wanted, which a page's own questions are not."""
        return [one for one in self.asked if one[0] not in ("state", "arm", "motion")]

    def _serve(self) -> None:
        while not self.over.is_set():
            if not self._socket.poll(20):
                continue
            request = decode_request([self._socket.recv()])
            self.asked.append((request.cmd, request.value))
            self.held.wait()
            more: dict[str, Any] = {"arm": {"arm": "an arm", "twin": None}, "motion": self.motion}.get(
                request.cmd, {}
            )
            if self.garbled:
                self._socket.send(b"\xc1")
            elif self.refused and self.wishes() and (request.cmd, request.value) == self.wishes()[-1]:
                self._socket.send(encode_refusal(self.refused))
            else:
                self._socket.send(encode_reply(self.state, **more))


@pytest.fixture
def playback(context: Context) -> Iterator[Playback]:
    made = Playback(context)
    yield made
    made.close()


@pytest.fixture
def remote(context: Context, playback: Playback) -> Iterator[Remote]:
    made = Remote(context, playback.endpoint)
    yield made
    playback.held.set()
    made.close()


def test_state_arm_and_motion_come_by_themselves(remote: Remote, playback: Playback) -> None:
    assert remote.answered.wait(60.0)
    assert remote.state == playback.state
    assert remote.arms == ("an arm", None)
    assert remote.motion is not None
    assert remote.motion.q == pytest.approx(np.array([[0.0, 1.0], [2.0, 3.0]]))
    assert remote.motion.twin_q is None
    assert playback.wishes() == []
    assert [cmd for cmd, _ in playback.asked[:3]] == ["state", "arm", "motion"]


def test_motion_is_asked_for_again_where_another_trial_is_loaded(remote: Remote, playback: Playback) -> None:
    assert remote.answered.wait(60.0)
    playback.state = playback.state | {"trial": 2}
    eventually(lambda: [cmd for cmd, _ in playback.asked].count("motion") == 2, "another motion")
    assert [cmd for cmd, _ in playback.asked].count("arm") == 1
    playback.state = playback.state | {"run": "b"}
    eventually(lambda: [cmd for cmd, _ in playback.asked].count("arm") == 2, "another run's arm")


@pytest.mark.parametrize(
    "motion",
    [{}, {"motion": None}, {"motion": {"t": [0.0]}}, {"motion": {**MOTION, "q": [[0.0, 1.0], [2.0]]}}],
    ids=["none", "no map", "no angles", "ragged"],
)
def test_a_motion_that_cannot_be_read_is_left_out(
    remote: Remote, playback: Playback, motion: dict[str, Any]
) -> None:
    assert remote.answered.wait(60.0)
    playback.motion, playback.state = motion, playback.state | {"trial": 2}
    eventually(lambda: remote.motion is None, "no motion")
    playback.motion, playback.state = {"motion": MOTION}, playback.state | {"trial": 3}
    eventually(lambda: remote.motion is not None, "the next one")


def test_of_many_seeks_the_last_counts_and_steps_add_up(remote: Remote, playback: Playback) -> None:
    assert remote.answered.wait(60.0)
    playback.held.clear()
    n = len(playback.asked)
    eventually(lambda: len(playback.asked) > n, "a question that is not answered yet")
    for wish in (("seek", 1.0), ("step", 1), ("seek", 2.0), ("step", 10), ("play", None), ("seek", 3.0)):
        remote.want(*wish)
    playback.held.set()
    eventually(lambda: len(playback.wishes()) == 3, "all wishes")
    assert playback.wishes() == [("step", 11), ("play", None), ("seek", 3.0)]


def test_a_refusal_is_kept_until_a_wish_is_granted(remote: Remote, playback: Playback) -> None:
    assert remote.answered.wait(60.0)
    playback.refused = "not there"
    remote.want("seek", 99.0)
    eventually(lambda: remote.refusal == "not there", "a refusal")
    playback.refused = ""
    remote.want("seek", 1.0)
    eventually(lambda: remote.refusal == "", "no refusal")


def test_what_is_no_playback_is_said(remote: Remote, playback: Playback) -> None:
    assert remote.answered.wait(60.0)
    playback.garbled = True
    remote.want("play")
    eventually(lambda: remote.refusal == "what answers there is no playback", "a refusal")
    playback.garbled = False
    remote.want("play")
    eventually(lambda: remote.refusal == "", "a playback again")


def test_who_does_not_answer_is_given_up_and_asked_anew(
    remote: Remote, playback: Playback, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert remote.answered.wait(60.0)
    monkeypatch.setattr("playback.view.remote.PATIENCE_S", 0.1)
    playback.held.clear()
    eventually(lambda: remote.state is None, "nobody answers")
    monkeypatch.setattr("playback.view.remote.PATIENCE_S", 60.0)
    playback.held.set()
    eventually(lambda: remote.state == playback.state, "an answer")


def test_a_twin_s_motion_comes_with_its_arm_s() -> None:
    alone = Motion(MOTION)
    assert alone.twin_q is None and alone.twin_tip is None and alone.tip.shape == (2, 3)
    both = Motion({**MOTION, "twin_q": [[5, 6], [7, 8]], "twin_tip": [[0, 0, 1], [0, 0, 2]]})
    assert both.twin_q is not None and both.twin_q.tolist() == [[5.0, 6.0], [7.0, 8.0]]
    assert both.twin_tip is not None and both.twin_tip.dtype == float


class Line:
    """Stands for a socket on which an answer comes after some looks at it, each a sixteenth of a second."""

    def __init__(self, looks: int, now_s: list[float]) -> None:
        self.looks, self.now_s = looks, now_s
        self.closed = False

    def send(self, payload: bytes) -> None:
        assert decode_request([payload]).cmd == "state"

    def poll(self, timeout_ms: int) -> bool:
        assert timeout_ms == 50
        self.looks -= 1
        self.now_s[0] += 1.0 / 16.0
        return self.looks < 0

    def close(self, linger_ms: int) -> None:
        self.closed = True


@pytest.mark.parametrize(
    ("looks", "over", "left"), [(0, False, -1), (1, False, -1), (48, False, -1), (99, False, 50), (99, True, 98)]
)
def test_an_answer_is_waited_for_three_seconds_unless_all_is_over(
    monkeypatch: pytest.MonkeyPatch, looks: int, over: bool, left: int
) -> None:
    now_s, state = [8.0], {"run": "a"}
    line, another = Line(looks, now_s), Line(0, now_s)
    reply = SimpleNamespace(parts=[encode_reply(state)])
    monkeypatch.setattr("playback.view.remote.time", SimpleNamespace(monotonic=lambda: now_s[0]))
    monkeypatch.setattr("playback.view.remote.receive_parts", lambda *_: reply)
    remote: Any = Remote.__new__(Remote)  # without its thread
    vars(remote).update(_socket=line, _over=over, _connect=lambda: another, state={"run": "before"})
    found = remote._ask(Request("state"))
    assert line.looks == left
    if left < 0:
        assert found is not None and found["ok"] is True and remote.state == state
        assert remote._socket is line and not line.closed
    else:
        assert found is None and remote.state is None
        assert remote._socket is another and line.closed
