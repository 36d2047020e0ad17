"""What leaves: to subscribers what they may have, to the recorder the same bytes and the raw samples always."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import zmq

from daemon.monitoring.health import Delay
from daemon.publishing.motion_blocks import RawSamples
from daemon.publishing.outlet import Outlet
from daemon.recording.record_link import Context, Entry, RecordInlet, RecordLink
from protocol.message import FRAMES, PLOT, RAW, TRIAL, decode
from protocol.publisher import Publisher
from tests.patience import PATIENCE_S
from tracking.model.frames import Frames, Phase

RATE_HZ = 32000.0


class Room:
    """An outlet and the recorder's end of it."""

    def __init__(self, context: Context, folder: Path, publish_raw: bool) -> None:
        self.context = context
        self.inlet = RecordInlet(self.context, f"ipc://{folder}/recorder")
        self.link = RecordLink(self.context, f"ipc://{folder}/recorder", "x.mcap")
        self.publisher = Publisher(self.context, f"ipc://{folder}/frames", "dd-arm", "run-1")
        self.delay = Delay()
        self.outlet = Outlet(
            self.publisher,
            self.link,
            arm_name="dd-arm",
            run="run-1",
            method="integrate",
            publish_raw=publish_raw,
            learning=5,
            delay=self.delay,
        )

    def recorded(self) -> list[Entry]:
        """End the recording and return what is in it."""
        self.link.close()
        entries = []
        while not self.inlet.ended:
            entries += self.inlet.receive(PATIENCE_S)
        return entries

    def close(self) -> None:
        self.publisher.close()
        self.inlet.close()
        self.context.destroy(linger=0)


@pytest.fixture(params=[False, True], ids=["raw-private", "raw-published"])
def room(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Room]:
    with zmq.Context() as context:  # also where a room could not be made
        made = Room(context, tmp_path, request.param)
        yield made
        made.close()


def frames(first: int, n: int, gap: bool = False) -> Frames:
    two, three = np.zeros((n, 2)), np.zeros((n, 3))
    return Frames(first, first * 10**6, 1e-3, two, two, two, three, np.zeros((n, 4, 3)), gap)


def test_raw_samples_are_always_recorded(room: Room) -> None:
    for k in range(3):
        room.outlet.send_raw(RawSamples(320 * k, 10**7 * k, 1 / RATE_HZ, np.full((320, 12), float(k)), 0))
    entries = room.recorded()
    messages = [decode([entry.topic.encode(), entry.payload])[1] for entry in entries]
    assert [entry.topic for entry in entries] == [RAW] * 3
    assert [entry.t_ns for entry in entries] == [0, 10**7, 2 * 10**7]
    assert [(m["seq"], m["sample0"], m["run"], m["arm"]) for m in messages] == [
        (k, 320 * k, "run-1", "dd-arm") for k in range(3)
    ]
    assert room.publisher.last_seq in ({}, {RAW: 2})


def test_frames_before_a_phase_are_sent_before_it(room: Room) -> None:
    assert room.outlet.send_frames([frames(0, 14)]) == 2
    for trial in (5, 6):
        room.outlet.send_phase(Phase("begin", 13_000_000, trial))
    room.outlet.send_frames([frames(14, 3)])
    entries = room.recorded()
    assert [entry.topic for entry in entries] == [FRAMES, FRAMES, PLOT, TRIAL, TRIAL, FRAMES]
    counts = [decode([b"", entry.payload])[1].get("last_seq") for entry in entries if entry.topic == FRAMES]
    assert counts == [None, None, {TRIAL: 1}]
    first, second = (decode([b"", entry.payload])[1] for entry in entries if entry.topic == TRIAL)
    assert (first["role"], second["role"]) == ("learn", "evaluate")
    assert first["last_seq"] == {FRAMES: 1, PLOT: 0} and second["last_seq"] == {FRAMES: 1, PLOT: 0, TRIAL: 0}


def test_rows_to_plot_are_sent_five_at_a_time(room: Room) -> None:
    room.outlet.send_frames([frames(0, 120)])
    room.outlet.flush()
    room.outlet.flush()
    entries = [entry for entry in room.recorded() if entry.topic == PLOT]
    rows = [[row["ts"] for row in decode([PLOT.encode(), entry.payload])[1]["rows"]] for entry in entries]
    assert [len(one) for one in rows] == [5, 5, 2]
    assert np.concatenate(rows) == pytest.approx(0.01 * np.arange(12))
    assert [entry.t_ns for entry in entries] == [0, 50_000_000, 100_000_000]


def test_what_bridges_a_gap_is_marked_and_has_no_delay(room: Room) -> None:
    room.outlet.send_frames([frames(0, 4)])
    room.outlet.send_bridge([frames(4, 2), frames(6, 25, gap=True)])
    assert room.outlet.send_frames([frames(31, 12, gap=True)]) == 2
    blocks = [decode([b"", entry.payload])[1] for entry in room.recorded() if entry.topic == FRAMES]
    assert [(block["frame0"], block["n"], block["gap"]) for block in blocks] == [
        *((0, 4, False), (4, 2, False), (6, 10, True), (16, 10, True), (26, 5, True)),
        *((31, 10, True), (41, 2, False)),
    ]
    assert room.delay.frames == 6 + 12
