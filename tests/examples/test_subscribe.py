"""The example that needs nothing of ours, against what the daemon really sends."""

import select
import subprocess
import sys
from pathlib import Path

import numpy as np
import zmq

from protocol.message import FRAMES
from protocol.publisher import Publisher

EXAMPLE = Path(__file__).parents[2] / "examples" / "subscribe.py"
ATTEMPTS = 600  # of 50 ms; never reached where all is well


def frames(frame0: int) -> dict[str, object]:
    """Return a block of ten frames whose last is at 30 and -90 degrees."""
    q = np.linspace([0.0, 0.0], np.radians([30.0, -90.0]), 10)
    fields = {"frame0": frame0, "t0_ns": 0, "dt_s": 1e-3, "n": 10, "method": "integrate", "gap": False}
    return {**fields, "q": q, "dq": q, "ddq": q, "tip": np.zeros((10, 3)), "points": np.zeros((10, 4, 3))}


def test_it_prints_the_last_angles_of_every_block_in_degrees() -> None:
    with zmq.Context() as context, Publisher(context, "tcp://127.0.0.1:*", "dd-arm", "run") as publisher:
        command = [sys.executable, str(EXAMPLE), publisher.endpoint]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            try:
                for k in range(ATTEMPTS):  # the first blocks go to nobody, until it has subscribed
                    publisher.publish(FRAMES, frames(10 * k))
                    if select.select([process.stdout], [], [], 0.05)[0]:
                        break
                assert process.stdout is not None
                frame0, *angles = process.stdout.readline().split()
            finally:
                process.kill()
    assert int(frame0) in range(0, 10 * ATTEMPTS, 10)
    assert angles == ["30.00", "-90.00"]


def test_it_is_short_and_imports_only_pyzmq_and_msgpack() -> None:
    lines = EXAMPLE.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 15
    imported = {line.split()[1] for line in lines if line.startswith(("import ", "from "))}
    assert imported - sys.stdlib_module_names == {"msgpack", "zmq"}


def test_the_protocols_page_shows_it_as_it_is() -> None:
    page = (EXAMPLE.parents[1] / "docs" / "protocol.md").read_text(encoding="utf-8")
    assert EXAMPLE.read_text(encoding="utf-8") in page
