"""Messages between processes: a topic and a msgpack map, with arrays in plain bytes.

Any program with msgpack can read them; nothing is ever unpickled. One topic is an exception to the map:
`PLOT` is an array of flat maps, because that is what PlotJuggler reads. Here it looks like the others, with
the maps in the field ``rows``; on the wire each row carries ``v`` and ``seq``.
"""

import math
import reprlib
from collections.abc import Mapping, Sequence
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray

from limbcal.errors import ProtocolError

VERSION = 1
#: What a message may be at the most: bytes, dimensions of an array, maps and lists in one another. Conventions.
MAX_PAYLOAD_BYTES = 16 * 1024 * 1024
MAX_DIMENSIONS = 4
MAX_DEPTH = 8

FRAMES = "limb/frames"
RAW = "limb/raw"
PLOT = "limb/plot"
TRIAL = "limb/trial"
GAP = "limb/gap"
HEALTH = "limb/health"
KINEMATICS = "limb/kinematics"
DYNAMICS = "limb/dynamics"
DIAGNOSIS = "limb/diagnosis"
PLAY = "limb/play"
TOPICS = (FRAMES, RAW, PLOT, TRIAL, GAP, HEALTH, KINEMATICS, DYNAMICS, DIAGNOSIS, PLAY)

_DTYPES = {text: np.dtype(text) for text in ("<f8", "<f4", "<i8", "<i4", "<i2", "|b1")}
#: What an array's type is called on the wire, whatever its order of bytes is here.
_TEXTS = {
    there: text for text, dtype in _DTYPES.items() for there in (dtype.newbyteorder("<"), dtype.newbyteorder(">"))
}
#: Begun with for every message [bytes]: most fit, and it is small enough for the allocator's own heap. msgpack's
#: 256 KiB would be mapped from the system and given back each time.
_BUFFER_BYTES = 32 * 1024
_ARRAY_KEYS = {"dtype", "shape", "data"}


def encode_array(array: NDArray[Any]) -> dict[str, object]:
    """Return an array as ``{"dtype", "shape", "data"}``, little-endian and in C order.

    Parameters
    ----------
    array : ndarray of float64, float32, int64, int32, int16 or bool, at most 4 dimensions

    Raises
    ------
    ProtocolError
        If the array is of another type or has more dimensions.
    """
    text = _TEXTS.get(array.dtype)
    if text is None or array.ndim > MAX_DIMENSIONS:
        raise ProtocolError(
            f"array of {array.dtype} with {array.ndim} dimensions, expected one of {', '.join(_DTYPES)} "
            f"with at most {MAX_DIMENSIONS}"
        )
    little = array if array.dtype is _DTYPES[text] else array.astype(_DTYPES[text], copy=False)
    return {"dtype": text, "shape": list(array.shape), "data": little.tobytes()}


def decode_array(fields: Mapping[str, Any]) -> NDArray[Any]:
    """Return the array that `encode_array` took apart, as memory of its own.

    Raises
    ------
    ProtocolError
        If the type is not one of the allowed, or the shape does not fit the data.
    """
    text, shape, data = fields.get("dtype"), fields.get("shape"), fields.get("data")
    if not isinstance(text, str) or text not in _DTYPES:
        raise ProtocolError(f"array: dtype is {_short(text)}, expected one of {', '.join(_DTYPES)}")
    if not isinstance(shape, list | tuple) or len(shape) > MAX_DIMENSIONS or not all(map(_is_length, shape)):
        raise ProtocolError(f"array: shape is {_short(shape)}, expected up to {MAX_DIMENSIONS} lengths")
    if not isinstance(data, bytes):
        raise ProtocolError(f"array: data is {_kind(data)}, expected bytes")
    dtype = _DTYPES[text]
    if len(data) != math.prod(shape) * dtype.itemsize:
        raise ProtocolError(f"array: {len(data)} bytes, expected {math.prod(shape) * dtype.itemsize}")
    if dtype.kind == "b":  # a bool of any other byte than 0 and 1 would be undefined
        flat: NDArray[Any] = np.frombuffer(data, np.uint8) != 0
    else:
        flat = np.frombuffer(data, dtype).astype(dtype.newbyteorder("="))
    try:
        return flat.reshape(shape)
    except ValueError as error:  # an empty array whose other sides are beyond what numpy can address
        raise ProtocolError(f"array: shape is {shape}, expected one that fits in memory") from error


def encode(topic: str, fields: Mapping[str, Any]) -> list[bytes]:
    """Return the two parts of a message.

    Parameters
    ----------
    topic : str
    fields : mapping
        Plain values, lists and maps of them, numpy scalars and arrays. ``v`` is added. For `PLOT`: ``rows``,
        a list of flat maps, and ``seq``.

    Raises
    ------
    ProtocolError
        If a value cannot be sent, or the message is too big.
    """
    document: object = {**fields, "v": VERSION}
    if topic == PLOT:
        common = {"v": VERSION, "seq": fields.get("seq", 0)}
        document = [{**row, **common} for row in fields.get("rows", ())]
    try:
        payload: bytes = msgpack.packb(document, default=_plain, buf_size=_BUFFER_BYTES)
    except (TypeError, ValueError, OverflowError) as error:
        raise ProtocolError(f"{topic}: a field cannot be sent as msgpack: {error}") from error
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise ProtocolError(f"{topic}: payload of {len(payload)} bytes, expected at most {MAX_PAYLOAD_BYTES}")
    return [topic.encode(), payload]


def decode(parts: Sequence[bytes]) -> tuple[str, dict[str, Any]]:
    """Return topic and fields of a message, arrays restored.

    Raises
    ------
    ProtocolError
        If it is not two parts, too big, not msgpack, not a map with ``"v": 1``, or holds an array that is not
        one. No other exception leaves this function, whatever the bytes.
    """
    if len(parts) != 2:
        raise ProtocolError(f"message of {len(parts)} parts, expected 2: topic and payload")
    try:
        topic = parts[0].decode("utf-8")
    except UnicodeDecodeError as error:
        raise ProtocolError(f"topic is {parts[0][:40]!r}, expected UTF-8") from error
    return topic, decode_payload(topic, parts[1])


def decode_payload(topic: str, payload: bytes) -> dict[str, Any]:
    """Return the fields of a message's second part; see `decode`."""
    where = _cut(topic)
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise ProtocolError(f"{where}: payload of {len(payload)} bytes, expected at most {MAX_PAYLOAD_BYTES}")
    try:
        document = msgpack.unpackb(payload, ext_hook=_no_extension)
    except (ValueError, TypeError, OverflowError, msgpack.UnpackException) as error:
        raise ProtocolError(f"{where}: payload is not msgpack ({str(error) or type(error).__name__})") from error
    return fields_of(topic, document)


def fields_of(topic: str, document: object) -> dict[str, Any]:
    """Return the fields of a message that was unpacked, arrays restored; see `decode`."""
    where = _cut(topic)
    if topic == PLOT:
        return _plot_fields(document, where)
    if not isinstance(document, dict):
        raise ProtocolError(f"{where}: payload is {_kind(document)}, expected a map")
    _check_version(document, where)
    fields = {name: _restore(value, where, 1) for name, value in document.items()}
    _check_names(fields, where)
    return fields


def _plot_fields(document: object, where: str) -> dict[str, Any]:
    if not isinstance(document, list):
        raise ProtocolError(f"{where}: payload is {_kind(document)}, expected an array of maps")
    fields: dict[str, Any] = {"v": VERSION, "rows": []}
    for row in document:
        if not isinstance(row, dict) or not all(isinstance(value, int | float) for value in row.values()):
            raise ProtocolError(f"{where}: found {_short(row)}, expected a flat map of numbers")
        _check_version(row, where)
        _check_names(row, where)
        fields["seq"] = row.get("seq")
        fields["rows"].append({name: value for name, value in row.items() if name not in ("v", "seq")})
    return fields


def _check_version(document: Mapping[Any, Any], where: str) -> None:
    version = document.get("v")
    if type(version) is not int or version != VERSION:
        raise ProtocolError(f"{where}: message version is {_short(version)}, expected {VERSION}")


def _check_names(document: Mapping[Any, Any], where: str) -> None:
    for name in document:
        if not isinstance(name, str):
            raise ProtocolError(f"{where}: field name is {_short(name)}, expected a string")


def _restore(value: object, where: str, depth: int) -> object:
    if depth > MAX_DEPTH:
        raise ProtocolError(f"{where}: maps and lists nested more than {MAX_DEPTH} deep")
    if isinstance(value, dict):
        _check_names(value, where)
        if value.keys() == _ARRAY_KEYS:
            try:
                return decode_array(value)
            except ProtocolError as error:
                raise ProtocolError(f"{where}: {error}") from error
        return {name: _restore(item, where, depth + 1) for name, item in value.items()}
    if isinstance(value, list):
        return [_restore(item, where, depth + 1) for item in value]
    if value is None or isinstance(value, bool | int | float | str | bytes):
        return value
    raise ProtocolError(f"{where}: found {_kind(value)}, expected plain values")


def _plain(value: object) -> object:
    """Turn what numpy made into what msgpack packs."""
    if isinstance(value, np.ndarray):
        return encode_array(value)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, int):
        raise TypeError(f"found a whole number of {value.bit_length()} bits, expected at most 64")
    raise TypeError(f"found {_kind(value)}, expected plain values and arrays")


def _kind(value: object) -> str:
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def _no_extension(code: int, _data: bytes) -> object:
    raise ValueError(f"extension type {code}, expected plain values")


def _is_length(value: object) -> bool:
    return type(value) is int and 0 <= value <= MAX_PAYLOAD_BYTES


def _short(value: object) -> str:
    return _cut(reprlib.repr(value))  # a value nested a thousand deep must not exhaust the stack


def _cut(text: str) -> str:
    """Return a text as a sentence has room for it."""
    return text if len(text) <= 60 else text[:57] + "..."
