"""A publisher for the subscribers among the examples, and what they must print of it."""

import select
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import zmq

from protocol.message import FRAMES, PLAY
from protocol.publisher import Publisher

EXAMPLES = Path(__file__).parents[2] / "examples"
ATTEMPTS = 600  # of 50 ms; never reached where all is well
T0_NS = 1_795_247_962_072_103_456


def block(k: int, n: int = 10) -> dict[str, object]:
    """Return a block of frames as the daemon sends it, of values that tell rows and columns apart."""
    q = np.arange(2.0 * n).reshape(n, 2) / 7.0 + k
    tip = np.arange(3.0 * n).reshape(n, 3) / 3.0 - k
    fields = {
        "frame0": n * k,
        "t0_ns": T0_NS + 10_000_000 * k,
        "dt_s": 1e-3,
        "n": n,
        "method": "filter",
        "gap": False,
    }
    return {**fields, "q": q, "dq": q, "ddq": q, "tip": tip, "points": np.zeros((n, 4, 3))}


def check_printed(line: str) -> None:
    """Hold a printed line against the block that it must be of."""
    words = line.split()
    assert (words[0], words[2], words[5]) == ("t", "q", "tip")
    t, q1, q2, *tip = (float(word) for word in (*words[1:2], *words[3:5], *words[6:]))
    k = round((t - T0_NS / 1e9 - 0.009) * 100)
    assert k >= 0
    last = block(k)
    assert abs(t - (T0_NS / 1e9 + 0.01 * k + 0.009)) < 2e-6
    assert np.allclose([q1, q2], np.asarray(last["q"])[-1], atol=1e-9)
    assert np.allclose(tip, np.asarray(last["tip"])[-1], atol=1e-9)


def run_against_a_stream(command: Sequence[str], topic: str, n_line: int = 3) -> list[str]:
    """Start a subscriber with the endpoint as its argument, publish until it prints, and return its lines."""
    assert topic in (FRAMES, PLAY)
    with zmq.Context() as context, Publisher(context, "tcp://127.0.0.1:*", "dd-arm", "run") as publisher:
        with subprocess.Popen([*command, publisher.endpoint], stdout=subprocess.PIPE, bufsize=0) as process:
            assert process.stdout is not None
            said = b""
            try:
                for k in range(ATTEMPTS):  # the first go to nobody, until it has subscribed
                    publisher.publish(topic, block(k))
                    while select.select([process.stdout], [], [], 0.05)[0]:
                        more = process.stdout.read(4096)
                        assert more, f"it ended with {process.wait()}"
                        said += more
                    if said.count(b"\n") >= n_line:
                        break
            finally:
                process.kill()
    return said.decode().splitlines()[:n_line]
