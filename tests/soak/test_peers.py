"""Fifty honest subscribers beside ten hostile clients, on the real daemon and the real page."""

import http.client
import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import zmq

from protocol.message import FRAMES, HEALTH
from protocol.subscriber import Subscriber
from tests import hostile
from tests.daemon.live_run import PATIENCE_MS, Limbd
from tests.soak import Long

RATE_HZ, MEGABYTE, HONEST = 8_000.0, 1e6, 50
#: What the pipeline and the page may grow by [MB], and the pipeline's latency [ms].
MOST_GROWN, MOST_LATE = 50.0, 25.0
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


def test_ten_hostile_ones_harm_none_of_fifty(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    seconds = long.of(120.0, 6.0)
    device = limbd("virtual", "--rate-hz", str(RATE_HZ), "--trials", "1000", "--json")
    to = ("--method", "integrate", "--endpoint", "tcp://127.0.0.1:*", "--json")
    daemon = limbd("run", "--port", device.announcement()["port"], "--arm", "dd-arm", *to)
    announced = daemon.announcement()
    endpoint = announced["endpoint"]
    pipeline = psutil.Process(announced["processes"]["pipeline"])
    with zmq.Context() as context, page_of(endpoint) as (page, page_process):
        honest = [Subscriber(context, endpoint, [FRAMES, HEALTH]) for _ in range(HONEST)]
        crowd = None
        try:
            for subscriber in honest:
                assert subscriber.receive(PATIENCE_MS) is not None
            before = {process: process.memory_full_info().uss for process in (pipeline, page_process)}
            command = [sys.executable, "-c", _CROWD, endpoint.rpartition(":")[2], str(page)]
            crowd = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            assert crowd.stdout is not None and crowd.stdout.readline() == "\n"
            grown = dict.fromkeys(before, 0.0)
            received, begun_s, uptime_s, late_ms = 0, None, 0.0, []
            while begun_s is None or uptime_s < begun_s + seconds:
                for subscriber in honest:
                    while (message := subscriber.receive(0)) is not None:
                        received += message[0] == FRAMES
                        if message[0] == HEALTH and subscriber is honest[0]:
                            uptime_s = message[1]["uptime_s"]
                            begun_s = uptime_s if begun_s is None else begun_s
                            late_ms.append(message[1]["latency_ms"]["p99"])
                            for process, was in before.items():
                                now = (process.memory_full_info().uss - was) / MEGABYTE
                                grown[process] = max(grown[process], now)
                assert honest[0].receive(PATIENCE_MS) is not None
                assert crowd.poll() is None
            said, _ = crowd.communicate("", PATIENCE_MS / 1e3)
            sent, shown_out = json.loads(said)
        finally:
            if crowd is not None:
                crowd.kill()
                crowd.communicate()
            missed = [(subscriber.missed, subscriber.restarts) for subscriber in honest]
            for subscriber in honest:
                subscriber.close()
    assert daemon.stop() == 0
    assert device.stop() == 0
    assert missed == [({}, 0)] * HONEST
    assert all(shown_out)
    assert max(grown.values()) < MOST_GROWN
    worst_ms = max(late for late in late_ms if late is not None)
    if long.at_length:  # how late a busy machine makes it is not the peers' doing
        assert sorted(late_ms)[len(late_ms) // 2] < MOST_LATE
    long.note(
        f"{HONEST} honest beside {len(sent)} hostile ones, {seconds:g} s: {received} blocks of frames, 0 missed; "
        f"latency p99 of each second at most {worst_ms:.1f} ms; {sum(sent) / MEGABYTE:.0f} MB sent, shown out "
        f"{sum(shown_out)} times; pipeline and page grew by at most "
        f"{' and '.join(f'{one:.1f}' for one in grown.values())} MB"
    )
