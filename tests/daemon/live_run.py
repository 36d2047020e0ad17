"""The virtual arm and the daemon run with faults; what was published is held against what the device sent."""

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq
from numpy.typing import NDArray

from arm.arm_file import load_arm
from arm.counts import COUNT_M_S2
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from protocol.message import GAP, HEALTH, RAW
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS

Fields = dict[str, Any]
Heard = dict[str, list[Fields]]
Limbd = Callable[..., Any]
SEED = 3


def sent(rate_hz: float, samples: int) -> NDArray[np.int16]:
    """Return the counts that the virtual arm's device has at least this many samples of, (n_sample, n_channel)."""
    plan = BenchPlan(load_arm("dd-arm"), seed=SEED, rate_hz=rate_hz, trials=22)
    parts: list[NDArray[np.int16]] = []
    for stretch in stretches(plan):
        parts.append(stretch.counts)
        if sum(map(len, parts)) >= samples:
            return np.concatenate(parts)
    raise AssertionError(f"the virtual arm moves for less than {samples} samples")


def live_run(
    limbd: Limbd,
    folder: Path,
    schedule: str,
    rate_hz: float,
    samples: int,
    hear: Callable[[str, Fields], None] = lambda _topic, _fields: None,
    device_options: Sequence[str] = (),
    method: str = "integrate",
    until: Callable[[], bool] = lambda: True,
) -> tuple[Heard, str]:
    """Let the device send samples, faults among them; return all messages by topic, and what it said last.

    ``hear`` is called with every message as it comes; ``rate_hz`` is what the device's INFO says. The run goes on
    ``until`` something has happened, and for as many samples at least.
    """
    link, endpoint = folder / "device", f"ipc://{folder}/frames"
    bench = ("--link", str(link), "--rate-hz", str(rate_hz), "--seed", str(SEED))
    device = limbd("virtual", *bench, *(("--fault", schedule) if schedule else ()), *device_options, "--json")
    device.announcement()
    config = folder / "limbd.toml"
    config.write_text(
        f'[device]\nport = "{link}"\n[arm]\nfile = "dd-arm"\n[tracking]\nmethod = "{method}"\n'
        f'[publish]\nendpoint = "{endpoint}"\nraw = true\n'
    )
    heard: Heard = {RAW: [], GAP: [], HEALTH: []}
    with zmq.Context() as context, Subscriber(context, endpoint, list(heard)) as subscriber:
        daemon = limbd("run", "--config", str(config), "--json")
        daemon.announcement()
        while not until() or not heard[HEALTH] or _sampled(heard) < samples:
            topic, fields = subscriber.receive(PATIENCE_MS) or pytest.fail("nothing came any more")
            assert device.process.poll() is None, device.said  # heartbeats alone would go on for ever
            heard[topic].append(fields)
            hear(topic, fields)
        assert daemon.stop() == 0
        while (message := subscriber.receive(500)) is not None:
            heard[message[0]].append(message[1])
        assert not subscriber.missed
    assert device.stop() == 0
    return heard, device.said


def _sampled(heard: Heard) -> int:
    """Return how many samples the device has taken, by the last health."""
    health = heard[HEALTH][-1]
    return int(health["samples"] + health["lost_samples"])


def dropped(said: str) -> int:
    """Return how many frames the device had to drop: a machine that is busy may not read for a second."""
    found = re.search(r"frames dropped, as the host did not read: (\d+)", said)
    return 0 if found is None else int(found[1])


def check(heard: Heard, truth: NDArray[np.int16], until: float = math.inf) -> None:
    """Every published sample is in the ledger or missing there, and up to one right and in its place."""
    place, stamp = 0, 0
    gaps = {gap["sample0"]: gap["samples"] for gap in heard[GAP]}
    for block in heard[RAW]:
        place += gaps.get(place, 0)
        assert block["sample0"] == place
        if place < until:
            counts = np.rint(block["a"] / COUNT_M_S2)
            np.testing.assert_array_equal(counts, truth[place : place + block["n"]])
        assert block["t0_ns"] > stamp
        place, stamp = place + block["n"], block["t0_ns"]
    last = heard[HEALTH][-1]
    assert last["lost_samples"] == sum(gaps.values())
    assert last["samples"] == sum(block["n"] for block in heard[RAW])
