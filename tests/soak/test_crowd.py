"""Many subscribers, and one that never reads."""

from pathlib import Path

import psutil
import zmq

from protocol.message import FRAMES, HEALTH
from protocol.subscriber import Subscriber
from tests.daemon.live_run import Limbd
from tests.patience import PATIENCE_MS
from tests.soak import Long

RATE_HZ, MEGABYTE = 8_000.0, 1e6


def test_one_that_stalls_harms_nobody(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    seconds, live = long.of((60.0, 50), (6.0, 20))
    device = limbd("virtual", "--rate-hz", str(RATE_HZ), "--json")
    port = device.announcement()["port"]
    to = ("--method", "integrate", "--endpoint", "tcp://127.0.0.1:*", "--json")
    daemon = limbd("run", "--port", port, "--arm", "dd-arm", *to)
    announced = daemon.announcement()
    pipeline = psutil.Process(announced["processes"]["pipeline"])
    with zmq.Context() as context:
        stalled = context.socket(zmq.SUB)
        stalled.set(zmq.RCVHWM, 1)
        stalled.set(zmq.LINGER, 0)
        stalled.connect(announced["endpoint"])
        stalled.subscribe(b"")
        crowd = [Subscriber(context, announced["endpoint"], [FRAMES, HEALTH]) for _ in range(live)]
        uptime_s, received, half = 0.0, 0, 0
        while uptime_s < seconds:
            for subscriber in crowd:
                while (message := subscriber.receive(0)) is not None:
                    received += message[0] == FRAMES
                    uptime_s = message[1].get("uptime_s", uptime_s)
            if not half and uptime_s > seconds / 2:
                half = pipeline.memory_full_info().uss
            assert crowd[0].receive(PATIENCE_MS) is not None
        grown = (pipeline.memory_full_info().uss - half) / MEGABYTE
        missed = [subscriber.missed for subscriber in crowd if subscriber.missed]
        for subscriber in crowd:
            subscriber.close()
        stalled.close()
    assert not missed
    assert daemon.stop() == 0
    assert device.stop() == 0
    assert grown < 5.0
    long.note(
        f"1 stalled and {live} live subscribers, {seconds:g} s: {received} blocks of frames, none missed; the "
        f"pipeline's memory grew by {grown:.1f} MB in the second half"
    )
