"""The daemon's recordings in the eyes of the mcap tools."""

import json
from pathlib import Path

import msgpack
from mcap.reader import make_reader

from protocol.message import FRAMES, TOPICS, TRIAL
from tests.conftest import ShortRun
from tests.protocol.mcap_doctor import examine


def test_a_recording_is_sound(recording: Path) -> None:
    complaints = examine(recording)
    assert complaints.errors == []
    # the profile is ours; and a motion is known to have begun only once frames of later are out
    assert all("not a well-known one" in said or "goes back" in said for said in complaints.warnings)


def test_the_summary_says_what_is_in_it(recording: Path, short_run: ShortRun) -> None:
    with recording.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        attached = {part.name: part.media_type for part in reader.iter_attachments()}
    assert summary is not None and summary.statistics is not None
    topics = [topic for topic, _ in short_run.messages]
    counts = {summary.channels[k].topic: count for k, count in summary.statistics.channel_message_counts.items()}
    assert counts == {topic: topics.count(topic) for topic in (FRAMES, TRIAL)}
    assert attached == {"arm.toml": "application/toml", "limbd.toml": "application/toml"}
    assert len(summary.chunk_indexes) == summary.statistics.chunk_count > 0
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}


def test_every_channel_says_how_it_is_read(recording: Path) -> None:
    """By the MCAP registry: encodings ``msgpack`` and ``json``, described by a schema in ``jsonschema``."""
    with recording.open("rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            encoding = "json" if channel.topic == TRIAL else "msgpack"
            assert channel.topic in TOPICS and channel.message_encoding == encoding
            assert schema is not None and (schema.name, schema.encoding) == (channel.topic, "jsonschema")
            described = json.loads(schema.data)
            assert described["type"] == "object"
            decode = json.loads if encoding == "json" else msgpack.unpackb
            assert set(described["required"]) <= decode(message.data).keys()


def test_a_time_is_found_by_the_index(recording: Path) -> None:
    with recording.open("rb") as file:
        reader = make_reader(file)
        times = [message.log_time for _, _, message in reader.iter_messages(topics=[FRAMES])]
        middle = times[len(times) // 2]
        later = [m.log_time for _, _, m in reader.iter_messages(topics=[FRAMES], starting_at=middle)]
    assert later == sorted(time for time in times if time >= middle)
