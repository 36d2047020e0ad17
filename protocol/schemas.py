"""A JSON schema for every topic, so that a recording explains itself to whoever opens it."""

import json
from collections.abc import Mapping

from protocol.diagnosis_schema import DIAGNOSIS_FIELDS
from protocol.message import (
    DIAGNOSIS,
    DYNAMICS,
    FRAMES,
    GAP,
    HEALTH,
    KINEMATICS,
    PLAY,
    PLOT,
    RAW,
    TRIAL,
    VERSION,
)
from protocol.schema_parts import Schema, array, by_name, one

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


_VERSION: Schema = {"const": VERSION, "description": "version of the message format"}
_SEQ = one("integer", "counts the messages of this topic, from 0")

_COMMON: Schema = {
    "v": _VERSION,
    "arm": one("string", "name of the arm"),
    "run": one("string", "UUID of the process that sent it"),
    "seq": _SEQ,
}

_BLOCK: Schema = {
    "t0_ns": one("integer", "time of the first row", "ns"),
    "dt_s": one("number", "time from one row to the next", "s"),
    "n": one("integer", "number of rows"),
}

_MOVED: Schema = {
    "q": array("joint positions", "(n, joints)", "rad or m"),
    "dq": array("joint velocities", "(n, joints)", "rad/s or m/s"),
    "ddq": array("joint accelerations", "(n, joints)", "rad/s^2 or m/s^2"),
    "tip": array("tip position in the base frame", "(n, 3)", "m"),
}

_MOTION: Schema = {
    "frame0": one("integer", "number of the first frame, counted from the start of the run"),
    **_BLOCK,
    "method": one("string", "how the motion was found, such as integrate or filter"),
    **_MOVED,
    "points": array(
        "how far each sensor has moved in the base frame since tracking began: dead reckoning from the "
        "accelerations, never computed from the arm's lengths",
        "(n, sensors, 3)",
        "m",
    ),
    "gap": one("boolean", "samples were lost before this block, or in it: what is missing was predicted"),
}

_CLAIM: Schema = {
    "q_std": array(
        "standard deviations of the joint positions, by the tracker's own claim; absent where it makes none",
        "(n, joints)",
        "rad or m",
    ),
    "a": array(
        "what the sensors read, averaged to the frames: specific force in their own axes; not a number where lost",
        "(n, channels)",
        "m/s^2",
    ),
    "a_noise": array(
        "variance of the noise of these readings: white noise, and what the converter hides from all alike",
        "(2, channels)",
        "(m/s^2)^2",
    ),
}

_ESTIMATE: Schema = {
    "parameters": by_name(
        "what was learnt, by name of the parameter",
        {
            "type": "object",
            "properties": {
                "value": one("number", "the estimate, in SI units"),
                "std": {"type": ["number", "null"], "description": "its standard error"},
            },
        },
    ),
    "error": one("number", "cost of the best individual"),
    "generation": one("integer", "generations of the genetic algorithm so far"),
}

_LAST_SEQ = by_name("sequence number sent last, by topic", {"type": "integer"})

_HEALTH: Schema = {
    "uptime_s": one("number", "since the process started", "s"),
    "device": one("object", "what the device says of itself: the INFO of the serial protocol"),
    "last_seq": _LAST_SEQ,
    "samples": one("integer", "samples received"),
    "lost_samples": one("integer", "samples that the device sent and that never came"),
    "crc_errors": one("integer", "serial frames with a wrong checksum"),
    "resyncs": one("integer", "how often the start of a serial frame had to be searched for"),
    "reconnects": one("integer", "how often the device went away and came back"),
    "doubled": one("integer", "serial frames that came a second time"),
    "late": one("integer", "serial frames that came after they had been given up"),
    "strangers": one("integer", "serial frames of another device, or of other channels than it said"),
    "gaps": {
        **one("object", "where samples are missing"),
        "properties": {
            "causes": by_name("number of gaps by cause", {"type": "integer"}),
            "last": {"type": "array", "description": "the last ones, as in limb/gap"},
        },
    },
    "saturated": {"description": "readings at the end of a channel's range, in all or by channel"},
    "flat": {"description": "channels that do not change, their number or names"},
    "readings": by_name(
        "mean of each sensor's three axes since the last report [m/s^2]; null where nothing came",
        {"type": ["array", "null"], "items": {"type": ["number", "null"]}},
    ),
    "still": by_name("whether a sensor moved by no more than its noise since then", {"type": "boolean"}),
    "q": {
        "type": ["array", "null"],
        "items": {"type": ["number", "null"]},
        "description": "the last joint positions",
    },
    "q_units": {"type": "array", "items": {"type": "string"}, "description": "rad or m, of each joint"},
    "rate_hz": {
        "type": ["number", "null"],
        "description": "samples a second as measured, by the device's clock and the host's",
    },
    "rate": {
        **one("object", "the device's rate as it claims it, and as it is used"),
        "properties": {
            "claimed_hz": one("number", "what its INFO says", "Hz"),
            "in_use_hz": one("number", "what motion is integrated by", "Hz"),
            "std_ppm": {"type": ["number", "null"], "description": "standard error of rate_hz [1e-6]"},
        },
    },
    "clock_ppm": {"type": ["number", "null"], "description": "device clock against host clock [1e-6]"},
    "clock": {
        **one("object", "the device's clock and the host's"),
        "properties": {
            "ppm_std": {"type": ["number", "null"], "description": "standard error of clock_ppm"},
            "error_ms": {"type": ["number", "null"], "description": "standard error of a time stamp [ms]"},
            "host_ahead_s": one("number", "by how much the host's clock was set since the run began", "s"),
            "host_jumps": one("integer", "how often it was set"),
        },
    },
    "latency_ms": {
        **one("object", "from the arrival of a sample to its message", "ms"),
        "properties": {
            "p50": one("number", "median", "ms"),
            "p99": one("number", "99th percentile", "ms"),
            "p99_run": one("number", "of the run so far", "ms"),
        },
    },
    "delay_ms": {
        **one("object", "age of the frames when they were published: UTC then, less the frame's own time", "ms"),
        "properties": {
            "mean": {"type": ["number", "null"], "description": "over the frames since the last report [ms]"},
            "max": {"type": ["number", "null"], "description": "of the oldest of them [ms]"},
        },
    },
    "tracking": {
        **one("object", "how well the readings since the last report fit what the tracker expects of them"),
        "properties": {
            "method": one("string", "how the motion is found: filter or integrate"),
            "innovation": {
                "type": ["number", "null"],
                "description": "mean squared innovation by the filter's claim: about 1 or less where it is right",
            },
            "jolts": one("integer", "frames at which a joint's acceleration jumped"),
            "doubted": one("integer", "frames at which no motion of the arm explains the readings"),
            "wrong": one("boolean", "the readings contradict the filter: a wrong arm file, or a failing sensor"),
        },
    },
    "alarms": {
        "type": "array",
        "description": "what is wrong: name, subject, since_ns, found, and what to do about it",
    },
    "connected": one("boolean", "the device is there"),
    "recording_lost": one("integer", "messages that could not be recorded"),
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
    FRAMES: _topic("joint and tip motion in blocks", {**_MOTION, **_CLAIM, "last_seq": _LAST_SEQ}),
    PLAY: _topic(
        "playback in blocks",
        {
            **_MOTION,
            "frame0": one("integer", "number of the first frame, counted from the start of the trial"),
            "points": array("sensor positions in the base frame, by the arm's geometry", "(n, sensors, 3)", "m"),
            "source": one("string", "what is played"),
            "speed": one("number", "1 is the speed of the source"),
            "trial": one("integer", "number of the trial; 0 where what plays is live"),
            "position_s": one("number", "place of the first frame in the trial", "s"),
            "twin": {
                **one("object", "the virtual arm beside it; absent where there is none"),
                "properties": {"name": one("string", "what it is"), **_MOVED},
            },
        },
    ),
    RAW: _topic(
        "accelerations in blocks",
        {
            "sample0": one("integer", "number of the first sample, counted from the start of the run"),
            **_BLOCK,
            "a": array("specific force in the sensors' own frames", "(n, channels)", "m/s^2"),
        },
    ),
    PLOT: {
        "$schema": _DIALECT,
        "title": "joint motion for PlotJuggler, 100 Hz",
        "type": "array",
        "items": {
            "type": "object",
            "properties": {"ts": one("number", "time", "s"), "v": _VERSION, "seq": _SEQ},
            "additionalProperties": one("number", "a signal by its name, such as q1"),
            "required": ["ts", "v", "seq"],
        },
    },
    TRIAL: _topic(
        "a motion began or ended",
        {
            "trial": one("integer", "number of the motion"),
            "t_ns": one("integer", "when", "ns"),
            "state": one("string", "begin or end"),
            "role": one("string", "what the motion is for, such as learn or evaluate"),
            "last_seq": _LAST_SEQ,
        },
    ),
    GAP: _topic(
        "samples are missing, or the host's clock was set",
        {
            "sample0": one("integer", "number of the first missing sample"),
            "samples": one("integer", "how many are missing; 0 where only the clock was set"),
            "t_ns": one("integer", "when the first of them should have been taken", "ns"),
            "why": one("string", "the cause, in few words"),
            "exact": one("boolean", "the device's own count tells how many; else the host's clock does"),
        },
    ),
    HEALTH: _topic("how the daemon is doing, once a second", _HEALTH),
    KINEMATICS: _topic(
        "the best kinematics so far",
        {**_ESTIMATE, "frames": one("integer", "frames used")},
    ),
    DYNAMICS: _topic(
        "the best dynamics so far",
        {**_ESTIMATE, "samples": one("integer", "samples used")},
    ),
    DIAGNOSIS: _topic("why the calibrated simulation is wrong", DIAGNOSIS_FIELDS),
}

_ANY: Schema = {"$schema": _DIALECT, "title": "a message", "type": "object", "properties": _COMMON}


def schema_json(topic: str) -> bytes:
    """Return the JSON schema of a topic; one that is not known here gets that of any message."""
    return json.dumps(SCHEMAS.get(topic, _ANY)).encode()
