"""A JSON schema for every topic, so that a recording explains itself to whoever opens it."""

import json
from collections.abc import Mapping

from protocol.message import (
    DYNAMICS,
    FRAMES,
    HEALTH,
    KINEMATICS,
    PLAY,
    PLOT,
    RAW,
    TRIAL,
    VERSION,
)

Schema = dict[str, object]

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def _one(kind: str, description: str, unit: str = "") -> Schema:
    return {"type": kind, "description": f"{description} [{unit}]" if unit else description}


def _array(description: str, shape: str, unit: str = "") -> Schema:
    """Describe an array as it crosses the wire; its elements lie in C order in ``data``."""
    return {
        **_one("object", f"{description}, shape {shape}", unit),
        "properties": {
            "dtype": {
                "enum": ["<f8", "<f4", "<i8", "<i4", "<i2", "|b1"],
                "description": "element type, as numpy writes it",
            },
            "shape": {
                "type": "array",
                "items": {"type": "integer"},
                "description": "lengths, outermost first",
            },
            "data": {"type": "string", "contentEncoding": "binary", "description": "the elements, C order"},
        },
        "required": ["dtype", "shape", "data"],
    }


def _by_name(description: str, value: Schema) -> Schema:
    return {**_one("object", description), "additionalProperties": value}


_VERSION: Schema = {"const": VERSION, "description": "version of the message format"}
_SEQ = _one("integer", "counts the messages of this topic, from 0")

_COMMON: Schema = {
    "v": _VERSION,
    "arm": _one("string", "name of the arm"),
    "run": _one("string", "UUID of the process that sent it"),
    "seq": _SEQ,
}

_BLOCK: Schema = {
    "t0_ns": _one("integer", "time of the first row", "ns"),
    "dt_s": _one("number", "time from one row to the next", "s"),
    "n": _one("integer", "number of rows"),
}

_MOTION: Schema = {
    "frame0": _one("integer", "number of the first frame, counted from the start of the run"),
    **_BLOCK,
    "method": _one("string", "how the motion was found, such as integrate or filter"),
    "q": _array("joint positions", "(n, joints)", "rad or m"),
    "dq": _array("joint velocities", "(n, joints)", "rad/s or m/s"),
    "ddq": _array("joint accelerations", "(n, joints)", "rad/s^2 or m/s^2"),
    "tip": _array("tip position in the base frame", "(n, 3)", "m"),
    "points": _array(
        "how far each sensor has moved in the base frame since tracking began: dead reckoning from the "
        "accelerations, never computed from the arm's lengths",
        "(n, sensors, 3)",
        "m",
    ),
    "gap": _one("boolean", "samples were lost before this block, or in it: what is missing was predicted"),
}

_CLAIM: Schema = {
    "q_std": _array(
        "standard deviations of the joint positions, by the tracker's own claim; absent where it makes none",
        "(n, joints)",
        "rad or m",
    ),
}

_ESTIMATE: Schema = {
    "parameters": _by_name(
        "what was learnt, by name of the parameter",
        {
            "type": "object",
            "properties": {
                "value": _one("number", "the estimate, in SI units"),
                "std": {"type": ["number", "null"], "description": "its standard error"},
            },
        },
    ),
    "error": _one("number", "cost of the best individual"),
    "generation": _one("integer", "generations of the genetic algorithm so far"),
}

_HEALTH: Schema = {
    "uptime_s": _one("number", "since the process started", "s"),
    "last_seq": _by_name("sequence number sent last, by topic", {"type": "integer"}),
    "samples": _one("integer", "samples received"),
    "lost_samples": _one("integer", "samples that the device sent and that never came"),
    "crc_errors": _one("integer", "serial frames with a wrong checksum"),
    "resyncs": _one("integer", "how often the start of a serial frame had to be searched for"),
    "reconnects": _one("integer", "how often the device went away and came back"),
    "saturated": {"description": "readings at the end of a channel's range, in all or by channel"},
    "flat": {"description": "channels that do not change, their number or names"},
    "clock_ppm": {"type": ["number", "null"], "description": "device clock against host clock [1e-6]"},
    "latency_ms": {
        **_one("object", "from the arrival of a sample to its message", "ms"),
        "properties": {"p50": _one("number", "median", "ms"), "p99": _one("number", "99th percentile", "ms")},
    },
    "delay_ms": {
        **_one("object", "age of the frames when they were published: UTC then, less the frame's own time", "ms"),
        "properties": {
            "mean": {"type": ["number", "null"], "description": "over the frames since the last report [ms]"},
            "max": {"type": ["number", "null"], "description": "of the oldest of them [ms]"},
        },
    },
    "tracking": {
        **_one("object", "how well the readings since the last report fit what the tracker expects of them"),
        "properties": {
            "method": _one("string", "how the motion is found: filter or integrate"),
            "innovation": {
                "type": ["number", "null"],
                "description": "mean squared innovation by the filter's claim: about 1 or less where it is right",
            },
            "jolts": _one("integer", "frames at which a joint's acceleration jumped"),
            "doubted": _one("integer", "frames at which no motion of the arm explains the readings"),
            "wrong": _one("boolean", "the readings contradict the filter: a wrong arm file, or a failing sensor"),
        },
    },
    "connected": _one("boolean", "the device is there"),
    "recording_lost": _one("integer", "messages that could not be recorded"),
    "recording": {"description": "what is being recorded to; false or null where nothing is"},
    "disk_free_bytes": {"type": ["integer", "null"], "description": "room left where recordings go"},
}


def _topic(title: str, properties: Schema) -> Schema:
    merged = {**_COMMON, **properties}
    return {
        "$schema": _DIALECT,
        "title": title,
        "type": "object",
        "properties": merged,
        "required": list(_COMMON),
    }


SCHEMAS: Mapping[str, Schema] = {
    FRAMES: _topic("joint and tip motion in blocks", {**_MOTION, **_CLAIM}),
    PLAY: _topic(
        "playback in blocks",
        {
            **_MOTION,
            "frame0": _one("integer", "number of the first frame, counted from the start of the trial"),
            "points": _array("sensor positions in the base frame, by the arm's geometry", "(n, sensors, 3)", "m"),
            "source": _one("string", "what is played"),
            "speed": _one("number", "1 is the speed of the source"),
        },
    ),
    RAW: _topic(
        "accelerations in blocks",
        {
            "sample0": _one("integer", "number of the first sample, counted from the start of the run"),
            **_BLOCK,
            "a": _array("specific force in the sensors' own frames", "(n, channels)", "m/s^2"),
        },
    ),
    PLOT: {
        "$schema": _DIALECT,
        "title": "joint motion for PlotJuggler, 100 Hz",
        "type": "array",
        "items": {
            "type": "object",
            "properties": {"ts": _one("number", "time", "s"), "v": _VERSION, "seq": _SEQ},
            "additionalProperties": _one("number", "a signal by its name, such as q1"),
            "required": ["ts", "v", "seq"],
        },
    },
    TRIAL: _topic(
        "a motion began or ended",
        {
            "trial": _one("integer", "number of the motion"),
            "t_ns": _one("integer", "when", "ns"),
            "state": _one("string", "begin or end"),
            "role": _one("string", "what the motion is for, such as learn or evaluate"),
        },
    ),
    HEALTH: _topic("how the daemon is doing, once a second", _HEALTH),
    KINEMATICS: _topic(
        "the best kinematics so far",
        {**_ESTIMATE, "frames": _one("integer", "frames used")},
    ),
    DYNAMICS: _topic(
        "the best dynamics so far",
        {**_ESTIMATE, "samples": _one("integer", "samples used")},
    ),
}

_ANY: Schema = {"$schema": _DIALECT, "title": "a message", "type": "object", "properties": _COMMON}


def schema_json(topic: str) -> bytes:
    """Return the JSON schema of a topic; one that is not known here gets that of any message."""
    return json.dumps(SCHEMAS.get(topic, _ANY)).encode()
