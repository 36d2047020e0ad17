"""Recordings as they are written, by writers that are killed and on disks that are full."""

import json
import math
import os
import resource
import subprocess
import sys

import numpy as np
import pytest
from mcap.reader import make_reader

from limbcal.errors import DeviceError, ProtocolError
from protocol.message import FRAMES, GAP, HEALTH, PLOT, RAW, TRIAL, encode
from protocol.recording import FLUSH_PERIOD_S, RecordingWriter
from protocol.recording_reader import read_recording, recording_attachments
from protocol.schemas import schema_json

PERIOD_S = 0.01
#: Messages of one second at the usual block length.
SECOND = round(1.0 / PERIOD_S)

WRITE_UNTIL_KILLED = """
import sys
import numpy as np
from protocol.message import FRAMES, encode
from protocol.recording import RecordingWriter

k, rng = 0, np.random.default_rng(0)
writer = RecordingWriter(sys.argv[1], "arm", "config", clock=lambda: k * 0.01)
while True:
    writer.write(FRAMES, encode(FRAMES, {"seq": k, "q": rng.normal(size=(10, 2))})[1], k)
    sys.stdout.write(f"{k}\\n")
    sys.stdout.flush()
    k += 1
"""


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.mcap"


def numbers(path):
    return [fields["seq"] for _, fields, _ in read_recording(path)]


def fill(writer, clock, n, begin=0, size=20):
    rng = np.random.default_rng(begin)
    for k in range(begin, begin + n):
        clock.now += PERIOD_S
        writer.write(FRAMES, encode(FRAMES, {"seq": k, "q": rng.normal(size=(size, 2))})[1], k)


def test_another_reader_finds_the_messages_byte_for_byte(path, clock):
    sent = [
        (topic, encode(topic, {"x": np.arange(k)})[1], 7 * k)
        for k, topic in enumerate([RAW, FRAMES, RAW, GAP, "limb/other"])
    ]
    with RecordingWriter(path, "arm", "config", clock=clock) as writer:
        for topic, payload, t_ns in sent:
            writer.write(topic, payload, t_ns)
    with path.open("rb") as file:
        found = list(make_reader(file, validate_crcs=True).iter_messages())
    assert [(channel.topic, message.data, message.log_time) for _, channel, message in found] == sent
    assert [message.sequence for _, _, message in found] == [0, 0, 1, 0, 0]
    for schema, channel, _ in found:
        assert channel.message_encoding == "msgpack"
        assert (schema.name, schema.encoding) == (channel.topic, "jsonschema")
        assert schema.data == schema_json(channel.topic)


def test_what_plotting_programs_read_is_json_to_the_mcap_library_alone(path, clock):
    rows = [{"ts": 5.0 + 0.01 * k, "q1": 0.1 * k, "q_std1": math.nan if k else 0.5} for k in range(3)]
    health = {"seq": 4, "samples": 7, "rate_hz": None, "q": np.array([1.0, np.nan]), "gaps": {"last": [math.inf]}}
    trial = {"seq": 0, "trial": 1, "t_ns": 2**62 + 1, "state": "begin", "role": "learn"}
    with RecordingWriter(path, "arm", "config", clock=clock) as writer:
        writer.write(PLOT, encode(PLOT, {"rows": rows, "seq": 9})[1], 5_000_000_000)
        writer.write(HEALTH, encode(HEALTH, health)[1], 6_000_000_000)
        writer.write(TRIAL, encode(TRIAL, trial)[1], 7_000_000_000)
    with path.open("rb") as file:
        found = list(make_reader(file, validate_crcs=True).iter_messages(topics=[PLOT, HEALTH, TRIAL]))
    documents = [json.loads(message.data, parse_constant=pytest.fail) for _, _, message in found]
    encodings = {(channel.message_encoding, schema.encoding) for schema, channel, _ in found}
    assert encodings == {("json", "jsonschema")}
    assert documents == [
        *({**row, "q_std1": None if k else 0.5, "v": 1, "seq": 9} for k, row in enumerate(rows)),
        {**health, "q": [1.0, None], "gaps": {"last": [None]}, "v": 1},
        {**trial, "v": 1},
    ]
    assert [message.log_time for _, _, message in found[:3]] == [5_000_000_000, 5_010_000_000, 5_020_000_000]
    for (schema, _, _), document in zip(found, documents, strict=True):
        described = json.loads(schema.data)
        assert described["type"] == "object" and set(document) - set(described["properties"]) <= {"seq"}
    again = [(topic, fields) for topic, fields, _ in read_recording(path)]
    assert again[3:] == [(HEALTH, documents[3]), (TRIAL, documents[4])]
    row = again[1][1]["rows"][0]
    assert row["q1"] == pytest.approx(0.1) and math.isnan(row["q_std1"])


def test_arm_and_config_are_attached_at_once(path, clock):
    writer = RecordingWriter(path, "name = 'ä'", "[device]", clock=clock)
    expected = {"arm.toml": "name = 'ä'".encode(), "limbd.toml": b"[device]"}
    assert recording_attachments(path) == expected  # while it is still being written
    writer.close()
    assert recording_attachments(path) == expected
    with path.open("rb") as file:
        assert {a.name: a.data for a in make_reader(file).iter_attachments()} == expected


def test_chunks_are_zstd_and_of_half_a_second(path, clock):
    with RecordingWriter(path, "", "", clock=clock) as writer:
        fill(writer, clock, 3 * SECOND)
    with path.open("rb") as file:
        chunks = make_reader(file).get_summary().chunk_indexes
    assert len(chunks) == 6
    assert {chunk.compression for chunk in chunks} == {"zstd"}


@pytest.mark.parametrize("n", [1, 49, 51, 120, 237])
def test_what_is_older_than_half_a_second_can_be_read_while_it_is_written(path, clock, n):
    with RecordingWriter(path, "", "", clock=clock) as writer:
        fill(writer, clock, n)
        reader = read_recording(path)
        assert [fields["seq"] for _, fields, _ in reader] == list(range(n // 50 * 50))
        assert reader.cut


def test_polling_flushes_when_no_more_messages_come(path, clock):
    with RecordingWriter(path, "", "", clock=clock) as writer:
        fill(writer, clock, 3)
        assert numbers(path) == []
        clock.now += 0.5
        writer.poll()
        assert numbers(path) == [0, 1, 2]


@pytest.mark.parametrize("n", [3, 130, 1117])
def test_a_writer_that_is_killed_costs_half_a_second(path, n):
    writer = subprocess.Popen([sys.executable, "-c", WRITE_UNTIL_KILLED, path], stdout=subprocess.PIPE, text=True)
    with writer:
        written = [int(writer.stdout.readline()) for _ in range(n)][-1]
        writer.kill()  # SIGKILL, wherever it is just now
        written = max([written, *map(int, writer.stdout.read().split("\n")[:-1])])
    reader = read_recording(path)
    found = [fields["seq"] for _, fields, _ in reader]
    assert found == list(range(len(found)))
    assert written - 51 <= len(found) <= written + 2
    assert reader.cut
    assert recording_attachments(path) == {"arm.toml": b"arm", "limbd.toml": b"config"}


def test_a_file_that_is_there_is_not_overwritten(path, clock):
    path.write_bytes(b"precious")
    with pytest.raises(DeviceError, match="exists already"):
        RecordingWriter(path, "", "", clock=clock)
    assert path.read_bytes() == b"precious"


def test_a_folder_that_is_not_there_is_said(tmp_path, clock):
    with pytest.raises(DeviceError, match="cannot be written: No such file or directory"):
        RecordingWriter(tmp_path / "none" / "run.mcap", "", "", clock=clock)


def test_a_full_disk_is_said_and_what_was_written_stays(path, clock):
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    writer = RecordingWriter(path, "arm", "config", clock=clock)
    fill(writer, clock, 100)
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 20_000, hard))
    try:
        with pytest.raises(DeviceError, match="run.mcap cannot be written"):
            fill(writer, clock, 1000, begin=100)
        writer.close()  # harmless
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    found = numbers(path)
    assert found == list(range(len(found)))
    assert len(found) >= 100


def test_the_size_is_known_and_closing_may_be_repeated(path, clock):
    writer = RecordingWriter(path, "", "", clock=clock)
    begun = writer.size_bytes
    fill(writer, clock, SECOND)
    assert writer.size_bytes > begun > 0
    writer.close()
    writer.close()
    assert writer.size_bytes == path.stat().st_size


def test_what_was_flushed_is_not_unsafe_any_more(tmp_path):
    now = [0.0]
    with RecordingWriter(tmp_path / "x.mcap", "", "", clock=lambda: now[0]) as writer:
        for number in range(3):
            writer.write(GAP, encode(GAP, {"sample0": number})[1], number)
        assert writer.unsafe == 3
        now[0] += FLUSH_PERIOD_S
        writer.poll()  # a flush, not yet a sync: the kernel has them, and they need not be written again
        assert writer.unsafe == 0
        assert len(list(read_recording(writer.path))) == 3


def test_a_recording_knows_whether_it_goes_by_its_name(tmp_path):
    with RecordingWriter(tmp_path / "x.mcap", "", "") as writer:
        assert writer.is_there()
        writer.path.rename(tmp_path / "y.mcap")
        assert not writer.is_there()
        writer.path.write_bytes(b"another")
        assert not writer.is_there()


def test_chunks_are_closed_by_time_and_the_disk_has_them_by_time(path, clock, monkeypatch):
    synced = []
    fsync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda descriptor: (synced.append(clock.now), fsync(descriptor)))
    payload = encode(FRAMES, {"seq": 0})[1]
    with RecordingWriter(path, "", "", clock=clock) as writer:
        assert synced == [0.0, 0.0]  # the file and its name
        unsafe = []
        for now in (0.0, 0.49, 0.5, 0.99, 1.0, 1.49, 1.5, 1.99, 2.0):
            clock.now = now
            writer.write(FRAMES, payload, 0)
            unsafe.append(writer.unsafe)
        assert unsafe == [1, 2, 0, 1, 0, 1, 0, 1, 0]
        assert synced[2:] == [1.0, 2.0]
        clock.now = 2.4
        writer.copy(FRAMES, payload, 0, "msgpack")
        assert writer.unsafe == 1
    assert writer.unsafe == 0 and synced[4:] == [2.4]


def test_a_chunk_of_half_a_mebibyte_is_full(path, clock):
    noise = [np.random.default_rng(k).bytes(100 * 1024) for k in range(6)]
    with RecordingWriter(path, "", "", clock=clock) as writer:
        begun = writer.size_bytes
        for k in range(5):
            writer.write(FRAMES, encode(FRAMES, {"x": noise[k]})[1], k)
        assert writer.size_bytes == begun
        writer.write(FRAMES, encode(FRAMES, {"x": noise[5]})[1], 5)
        assert writer.size_bytes > begun + 500 * 1024


@pytest.mark.parametrize(("t_ns", "fits"), [(-1, False), (0, True), (2**64 - 1, True), (2**64, False)])
def test_a_time_has_64_bits(path, clock, t_ns, fits):
    with RecordingWriter(path, "", "", clock=clock) as writer:
        if fits:
            writer.write(FRAMES, encode(FRAMES, {"seq": 0})[1], t_ns)
        else:
            with pytest.raises(ProtocolError, match=f"time of the message is {t_ns} ns, expected 0 to"):
                writer.write(FRAMES, encode(FRAMES, {"seq": 0})[1], t_ns)
    assert [time_ns for *_, time_ns in read_recording(path)] == ([t_ns] if fits else [])


def test_messages_are_numbered_topic_by_topic(path, clock):
    with RecordingWriter(path, "", "", clock=clock) as writer:
        for topic in (FRAMES, RAW, FRAMES, FRAMES, RAW):
            writer.write(topic, encode(topic, {"seq": 9})[1], 7)
    with path.open("rb") as file:
        found = [
            (channel.topic, one.sequence, one.publish_time)
            for _, channel, one in make_reader(file).iter_messages()
        ]
        file.seek(0)
        attached = [(one.name, one.create_time, one.log_time) for one in make_reader(file).iter_attachments()]
    assert sorted(found) == [(FRAMES, 0, 7), (FRAMES, 1, 7), (FRAMES, 2, 7), (RAW, 0, 7), (RAW, 1, 7)]
    assert attached == [("arm.toml", 0, 0), ("limbd.toml", 0, 0)]


@pytest.mark.parametrize("room", range(20_000, 26_000, 1500))
def test_a_disk_that_is_full_within_a_chunk_leaves_none_of_it(path, clock, room):
    """What had not safely left is written to another file, and would be in both."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    writer = RecordingWriter(path, "", "", clock=clock)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    written = 0
    try:
        with pytest.raises(DeviceError, match="cannot be written"):
            for written in range(10**4):
                fill(writer, clock, 1, written, 2)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert numbers(path) == list(range(written - writer.unsafe + 1))
