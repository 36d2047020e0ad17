"""Fifty honest subscribers beside ten hostile clients, on the real daemon and the real page."""

import http.client
import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgpack
import psutil
import zmq

from protocol.message import FRAMES, HEALTH, decode
from protocol.subscriber import Subscriber
from tests import hostile
from tests.daemon.live_run import Limbd
from tests.patience import PATIENCE_MS
from tests.soak import Long

RATE_HZ, MEGABYTE, HONEST = 8_000.0, 1e6, 50
#: What the pipeline and the page may grow by [MB], and the pipeline's latency [ms].
MOST_GROWN, MOST_LATE = 50.0, 25.0
#: What stands before a message's number: a string of three characters (msgpack).
_SEQ = b"\xa3seq"
#: The hostile clients, in a process of their own.
_CROWD = """
import json, sys
from tests import hostile
from tests.soak.test_peers import ten_hostile
crowd = hostile.Crowd(ten_hostile(*map(int, sys.argv[1:])))
print(flush=True)
sys.stdin.read()
crowd.close()
print(json.dumps([crowd.sent, crowd.shown_out]))
"""


def from_elsewhere(port: int) -> Callable[[threading.Event], int]:
    """Return a foreign page, which a browser lets ask and open websockets."""

    def act(_over: threading.Event) -> int:
        for headers in (
            {"Origin": "http://evil.example"},
            {"Host": f"evil.example:{port}", "Origin": f"http://evil.example:{port}"},
        ):
            for more in ({}, {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}):
                line = http.client.HTTPConnection("127.0.0.1", port, timeout=30.0)
                try:
                    line.request("GET", "/", headers={**headers, **more})
                    if line.getresponse().status != http.HTTPStatus.FORBIDDEN:
                        raise SystemExit("a foreign page was let in")
                finally:
                    line.close()
        return 0

    return act


def ten_hostile(frames: int, page: int) -> list[Callable[[threading.Event], int]]:
    """Return what each of them does, again and again, to the daemon's port and the page's."""
    return [
        hostile.sending(frames, b"SUB", lambda: hostile.many_topics(60)),
        hostile.sending(frames, b"SUB", lambda: hostile.many_topics(400)),
        hostile.sending(frames, b"SUB", hostile.one_topic_again_and_again),
        hostile.sending(frames, b"SUB", lambda: hostile.parts_without_end(1)),
        hostile.sending(frames, b"SUB", lambda: hostile.parts_without_end(500)),
        hostile.sending(frames, b"SUB", lambda: hostile.messages(300)),
        hostile.sending(frames, b"SUB", hostile.noise),
        hostile.half_open(frames, 20),
        from_elsewhere(page),
        from_elsewhere(page),
    ]


@contextmanager
def page_of(endpoint: str) -> Iterator[tuple[int, psutil.Process]]:
    """Show what a daemon publishes; give the page's port and its process."""
    command = [sys.executable, "-m", "playback", "view", "--connect", endpoint, "--arm", "dd-arm"]
    command += ["--port", "0", "--no-open", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            lines = list(iter(process.stdout.readline, "}\n"))
            yield int(json.loads("".join([*lines, "}"]))["url"].rpartition(":")[2]), psutil.Process(process.pid)
            process.terminate()
            assert process.wait(PATIENCE_MS / 1e3) == 0
        finally:
            process.kill()


class Honest:
    """A subscriber that looks at numbers alone: fifty that read all would keep a processor busy, and fall behind.

    Attributes
    ----------
    received, missed : int
        Blocks of frames that came, and that did not.
    health : dict or None
        The last that came, if it reads those.
    """

    def __init__(self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, reads: bool) -> None:
        self.subscriber = Subscriber(context, endpoint, [FRAMES, HEALTH] if reads else [FRAMES])
        self.received, self.missed = 0, 0
        self.health: dict[str, Any] | None = None
        self._last: int | None = None

    def take(self) -> None:
        """Take in all that has come."""
        while self.subscriber.socket.poll(0):
            topic, payload = self.subscriber.socket.recv_multipart()
            if topic == HEALTH.encode():
                self.health = decode([topic, payload])[1]
                continue
            _, mark, rest = payload.rpartition(_SEQ)
            assert mark
            unpacker = msgpack.Unpacker()
            unpacker.feed(rest)
            seq = unpacker.unpack()
            self.missed += 0 if self._last is None else seq - self._last - 1
            self.received, self._last = self.received + 1, seq


def test_ten_hostile_ones_harm_none_of_fifty(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    seconds = long.of(120.0, 6.0)
    device = limbd("virtual", "--rate-hz", str(RATE_HZ), "--trials", "1000", "--json")
    to = ("--method", "integrate", "--endpoint", "tcp://127.0.0.1:*", "--json")
    daemon = limbd("run", "--port", device.announcement()["port"], "--arm", "dd-arm", *to)
    announced = daemon.announcement()
    endpoint = announced["endpoint"]
    pipeline = psutil.Process(announced["processes"]["pipeline"])
    with zmq.Context() as context, page_of(endpoint) as (page, page_process):
        honest = [Honest(context, endpoint, reads=k == 0) for k in range(HONEST)]
        crowd = None
        try:
            for one in honest:
                assert one.subscriber.socket.poll(PATIENCE_MS)
            before = {process: process.memory_full_info().uss for process in (pipeline, page_process)}
            command = [sys.executable, "-c", _CROWD, endpoint.rpartition(":")[2], str(page)]
            crowd = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            assert crowd.stdout is not None and crowd.stdout.readline() == "\n"
            grown = dict.fromkeys(before, 0.0)
            first = honest[0]
            begun_s = seen_s = None
            while seen_s is None or begun_s is None or seen_s < begun_s + seconds:
                assert first.subscriber.socket.poll(PATIENCE_MS)
                assert crowd.poll() is None
                for one in honest:
                    one.take()
                if first.health is not None and first.health["uptime_s"] != seen_s:
                    seen_s = first.health["uptime_s"]
                    begun_s = seen_s if begun_s is None else begun_s
                    for process, was in before.items():
                        grown[process] = max(grown[process], (process.memory_full_info().uss - was) / MEGABYTE)
            said, _ = crowd.communicate("", PATIENCE_MS / 1e3)
            sent, shown_out = json.loads(said)
        finally:
            if crowd is not None:
                crowd.kill()
                crowd.communicate()
            for one in honest:
                one.subscriber.close()
    assert daemon.stop() == 0
    assert device.stop() == 0
    assert [one.missed for one in honest] == [0] * HONEST
    assert first.health is not None
    assert first.health["lost_samples"] == 0
    assert all(shown_out)
    assert max(grown.values()) < MOST_GROWN
    p99_ms = first.health["latency_ms"]["p99_run"]
    if long.at_length:  # how late it is in a few seconds, beside other tests, is not the peers' doing
        assert p99_ms < MOST_LATE
    long.note(
        f"{HONEST} honest beside {len(sent)} hostile ones, {seconds:g} s: "
        f"{sum(one.received for one in honest)} blocks of frames, 0 missed; "
        f"latency p99 {p99_ms:.1f} ms; {sum(sent) / MEGABYTE:.0f} MB sent, shown out "
        f"{sum(shown_out)} times; pipeline and page grew by at most "
        f"{' and '.join(f'{one:.1f}' for one in grown.values())} MB"
    )
