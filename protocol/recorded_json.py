"""Topics that are recorded as JSON, so that Foxglove, PlotJuggler and the plain `mcap` library read them unaided.

On the wire they are msgpack as all others are. `limb/plot` is an array of rows there; recorded, each row is a
message of its own, because Foxglove takes no arrays for messages. JSON has no word for what is not a finite
number: that is null.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

from limbcal.errors import ProtocolError
from protocol.message import (
    HEALTH,
    MAX_PAYLOAD_BYTES,
    PLOT,
    TRIAL,
    VERSION,
    decode_payload,
    fields_of,
)
from protocol.schemas import SCHEMAS, schema_json

JSON_TOPICS = frozenset({PLOT, HEALTH, TRIAL})
JSON_ENCODING = "json"
_JSON = json.JSONEncoder(allow_nan=False, separators=(",", ":"))


def json_messages(topic: str, payload: bytes, t_ns: int) -> list[tuple[bytes, int]]:
    """Return what is recorded of a message of one of `JSON_TOPICS`: JSON and time [ns] of each.

    Parameters
    ----------
    topic : str
    payload : bytes
        The second part of the message, as it was sent.
    t_ns : int
        Its time; rows of `limb/plot` that follow the first are by their own ``ts`` later.

    Raises
    ------
    ProtocolError
        If the message is none.
    """
    fields = decode_payload(topic, payload)
    if topic != PLOT:
        return [(_dumped(topic, fields), t_ns)]
    rows, common = fields["rows"], {"v": VERSION, "seq": fields.get("seq", 0)}
    return [
        (_dumped(topic, {**row, **common}), t_ns + round(1e9 * (row.get("ts", 0.0) - rows[0].get("ts", 0.0))))
        for row in rows
    ]


def decode_json(topic: str, payload: bytes) -> dict[str, Any]:
    """Return the fields of a recorded message, `limb/plot` with the one row in ``rows``.

    Raises
    ------
    ProtocolError
        If it is not strict JSON, or not a message of this version.
    """
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise ProtocolError(f"{topic}: payload of {len(payload)} bytes, expected at most {MAX_PAYLOAD_BYTES}")
    try:
        document = json.loads(payload.decode("utf-8"), parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise ProtocolError(f"{topic}: payload is not JSON ({error or type(error).__name__})") from error
    if topic == PLOT:
        row = document if isinstance(document, dict) else {}
        document = [{name: math.nan if value is None else value for name, value in row.items()}]
    return fields_of(topic, document)


def recorded_schema(topic: str, first: bytes) -> bytes:
    """Return the JSON schema of a topic as it is recorded; `limb/plot` has the columns of its first row."""
    if topic != PLOT:
        return schema_json(topic)
    schema: Any = SCHEMAS[PLOT]
    items, number = schema["items"], {"type": ["number", "null"], "description": "a signal by its name"}
    (row,) = decode_json(PLOT, first)["rows"]
    columns = {name: number for name in row if name not in items["properties"]}
    described = {
        **{name: schema[name] for name in ("$schema", "title")},
        **items,
        "properties": {**items["properties"], **columns},
        "additionalProperties": number,
    }
    return json.dumps(described).encode()


def _dumped(topic: str, document: Mapping[str, Any]) -> bytes:
    try:
        try:
            return _JSON.encode(document).encode()  # as nearly always: plain values, all of them finite
        except (TypeError, ValueError):
            return _JSON.encode(_strict(document)).encode()
    except (TypeError, ValueError) as error:
        raise ProtocolError(f"{topic}: a field cannot be recorded as JSON: {error}") from error


def _strict(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _strict(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_strict(item) for item in value]
    if hasattr(value, "tolist"):
        return _strict(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _no_constant(word: str) -> object:
    raise ValueError(f"found {word}, expected a finite number")
