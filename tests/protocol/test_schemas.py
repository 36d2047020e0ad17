"""The schemas name and describe every field of the contract."""

import json

import pytest

from protocol.message import DIAGNOSIS, DYNAMICS, FRAMES, GAP, HEALTH, KINEMATICS, PLAY, PLOT, RAW, TOPICS, TRIAL
from protocol.schemas import SCHEMAS, schema_json

MOTION = "frame0 t0_ns dt_s n method q dq ddq tip points gap"
FIELDS = {
    FRAMES: MOTION + " q_std a a_noise last_seq",
    PLAY: MOTION + " source speed trial position_s twin",
    RAW: "sample0 t0_ns dt_s n a",
    TRIAL: "trial t_ns state role last_seq",
    GAP: "sample0 samples t_ns why exact",
    HEALTH: "uptime_s last_seq samples lost_samples crc_errors resyncs reconnects doubled late strangers gaps "
    "saturated flat readings still q q_units rate_hz rate clock_ppm clock latency_ms delay_ms tracking alarms "
    "connected recording recording_lost disk_free_bytes device",
    KINEMATICS: "generation frames parameters error",
    DYNAMICS: "generation samples parameters error",
    DIAGNOSIS: "verdict complete left causes candidates confusable next_experiment before after gain residual "
    "explained structure suspected notes polished polish judged",
}


def test_every_topic_has_a_schema():
    assert set(SCHEMAS) == set(TOPICS)


@pytest.mark.parametrize("topic", FIELDS)
def test_every_field_of_the_contract_is_there(topic):
    assert set(SCHEMAS[topic]["properties"]) == {"v", "arm", "run", "seq", *FIELDS[topic].split()}


@pytest.mark.parametrize("topic", TOPICS)
def test_every_field_is_described(topic):
    schema = SCHEMAS[topic]
    if topic == PLOT:
        schema = schema["items"]
    assert all(field["description"] for field in schema["properties"].values())
    assert set(schema["required"]) <= set(schema["properties"])


@pytest.mark.parametrize("topic", [*TOPICS, "limb/other"])
def test_a_schema_is_json(topic):
    assert json.loads(schema_json(topic))["$schema"].startswith("https://json-schema.org/")
