"""What goes wrong on a real tty: nothing wrong is published, and every missing sample is in the ledger."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq

from arm.arm_file import load_arm
from arm.bench import COUNT_M_S2
from daemon.virtual_motion import BenchPlan, stretches
from protocol.message import GAP, HEALTH, RAW
from protocol.subscriber import Subscriber

RATE_HZ = 8000.0
PATIENCE_MS = 30_000
Fields = dict[str, Any]
Limbd = Callable[..., Any]


@pytest.fixture(scope="module")
def truth() -> np.ndarray:
    plan = BenchPlan(load_arm("dd-arm"), seed=3, rate_hz=RATE_HZ, trials=22)
    return np.concatenate([stretch.counts for _, stretch in zip(range(4), stretches(plan), strict=False)])


@pytest.fixture
def streamed(limbd: Limbd, tmp_path: Path) -> Iterator[Callable[..., dict[str, list[Fields]]]]:
    """Let the virtual arm and the daemon run with some faults; return all messages by topic."""
    context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()

    def run(schedule: str, samples: int) -> dict[str, list[Fields]]:
        link, endpoint = tmp_path / "device", f"ipc://{tmp_path}/frames"
        device = limbd(
            "virtual", "--link", str(link), "--rate-hz", "8000", "--seed", "3", "--fault", schedule, "--json"
        )
        device.announcement()
        config = tmp_path / "limbd.toml"
        config.write_text(
            f'[device]\nport = "{link}"\n[arm]\nfile = "dd-arm"\n[tracking]\nmethod = "integrate"\n'
            f'[publish]\nendpoint = "{endpoint}"\nraw = true\n'
        )
        heard: dict[str, list[Fields]] = {RAW: [], GAP: [], HEALTH: []}
        with Subscriber(context, endpoint, [RAW, GAP, HEALTH]) as subscriber:
            daemon = limbd("run", "--config", str(config), "--json")
            daemon.announcement()
            while not heard[HEALTH] or heard[HEALTH][-1]["samples"] + heard[HEALTH][-1]["lost_samples"] < samples:
                topic, fields = subscriber.receive(PATIENCE_MS) or pytest.fail("nothing came any more")
                heard[topic].append(fields)
            assert daemon.stop() == 0
            while (message := subscriber.receive(500)) is not None:
                heard[message[0]].append(message[1])
            assert not subscriber.missed
        assert device.stop() == 0
        heard["said"] = [device.said]  # type: ignore[list-item]
        return heard

    yield run
    context.term()


def check(heard: dict[str, list[Fields]], truth: np.ndarray) -> None:
    """Every published sample is right and in its place; what is missing is in the ledger, to the sample."""
    place, stamp = 0, 0
    gaps = {gap["sample0"]: gap["samples"] for gap in heard[GAP]}
    for block in heard[RAW]:
        place += gaps.get(place, 0)
        assert block["sample0"] == place
        counts = np.rint(block["a"] / COUNT_M_S2)
        np.testing.assert_array_equal(counts, truth[place : place + block["n"]])
        assert block["t0_ns"] > stamp
        place, stamp = place + block["n"], block["t0_ns"]
    last = heard[HEALTH][-1]
    assert last["lost_samples"] == sum(gaps.values())
    assert last["samples"] == sum(block["n"] for block in heard[RAW])


SCHEDULE = (
    "unplug@0.5+0.4/20, garbage@1.4+0.4*20000, silent@2.2+0.5, baud@3.2+0.4, flip@4.2+1.5*1e-4,"
    "double@6.2+1.2*0.05, reorder@6.2+1.2*0.05, drop@6.2+1.2*0.02, stranger@8+0.8"
)


def test_what_is_published_is_right_and_what_is_missing_is_told(
    streamed: Callable[..., dict[str, list[Fields]]], truth: np.ndarray
) -> None:
    heard = streamed(SCHEDULE, 80_000)
    check(heard, truth)
    assert {gap["why"] for gap in heard[GAP]} == {
        *("unplugged", "the device was silent", "damaged on the line", "frames missing")
    }
    assert all(gap["exact"] for gap in heard[GAP])
    last, said = heard[HEALTH][-1], str(heard["said"])
    assert f"{last['crc_errors']} by flip" in said
    assert last["reconnects"] == 3  # the stranger was plugged in, too
    assert last["strangers"] > 0
    assert last["doubled"] > 0 and last["late"] == 0
    unplugged = [gap["samples"] / RATE_HZ for gap in heard[GAP] if gap["why"] == "unplugged"]
    assert 0.4 < unplugged[0] < 2.4  # back within two seconds


def test_a_device_that_lost_its_power_is_started_again(
    streamed: Callable[..., dict[str, list[Fields]]], truth: np.ndarray
) -> None:
    heard = streamed("restart@1.5+0.5", 28_000)
    (gap,) = heard[GAP]
    assert (gap["why"], gap["exact"]) == ("the device was restarted", False)
    after = next(block for block in heard[RAW] if block["sample0"] > gap["sample0"])
    at = after["sample0"]
    counts = np.rint(after["a"] / COUNT_M_S2)
    shifts = [s for s in range(-800, 801) if np.array_equal(truth[at + s : at + s + len(counts)], counts)]
    assert len(shifts) == 1  # as far off as the host is unsure of when it heard the device, in samples
