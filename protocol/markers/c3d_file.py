"""C3D, the file of motion laboratories, read by ezc3d."""

import struct
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from limbcal.errors import ConfigError, DataError
from limbcal.memory_limit import memory_limit
from protocol.markers.recording import ForceRecord, RawRecording
from protocol.tables.table import Floats

#: The second byte of every C3D file.
_KEY = 0x50
#: A larger file is not read at once [byte].
LARGEST_BYTES = 2_000_000_000
#: What ezc3d may take for a byte of the file, and beside that [byte]: a sample of 16 bits becomes an object of
#: some 48 bytes and a double in two arrays, 32 times as much, and twice that is let pass. A damaged count asks for
#: more.
_MEMORY_PER_BYTE, _MEMORY_BYTES = 64, 2**26
#: The C3D file format (www.c3d.org): the first and the last frame stand at byte 6 of the header, as 16-bit words.
#: The largest word says that the number is larger. The processor is the fourth byte of the parameters, whose block
#: is the file's first byte: 84 is Intel's and 85 DEC's.
_HEAD_BYTES, _FRAMES, _UNKNOWN_FRAME = 12, 6, 0xFFFF
_BLOCK_BYTES, _PROCESSOR, _LITTLE_ENDIAN = 512, 3, (b"T", b"U")
_NO_MEMORY = "bad_alloc"  # what C++ calls it, as ezc3d hands it on
#: Groups of labels that stand among the points and are none.
_COMPUTED = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS")


def read_c3d(path: Path) -> RawRecording:
    """Read a C3D file.

    Raises
    ------
    ConfigError
        If ezc3d is not installed.
    DataError
        If it is no C3D file, or one that cannot be read.
    """
    try:
        import ezc3d  # noqa: PLC0415 - only who has C3D files needs it
    except ImportError:
        raise ConfigError(f"{path}: C3D files need ezc3d; install it with: pip install 'limbcal[human]'") from None
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        raise DataError(f"{path}: it has {size} bytes, expected at most {LARGEST_BYTES}")
    with path.open("rb") as file:
        begin = file.read(2)
    if len(begin) < 2 or begin[1] != _KEY:
        raise DataError(f"{path}: its second byte is {begin[1:].hex() or 'missing'}, expected 50 of a C3D file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with memory_limit(_MEMORY_PER_BYTE * size + _MEMORY_BYTES):
                file = ezc3d.c3d(str(path))
    except (OSError, RuntimeError, ValueError, IndexError, OverflowError, MemoryError) as error:
        why = str(error)
        if isinstance(error, MemoryError) or _NO_MEMORY in why:
            why = f"a count in it asks for more memory than {size} bytes can fill; is it damaged?"
        raise DataError(f"{path}: the C3D file cannot be read: {why}") from error
    return replace(_recording(path, file), stated_frames=_stated_frames(path))


def _stated_frames(path: Path) -> int | None:
    """Return how many frames there are by the header itself: ezc3d puts it right where the file ends early."""
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
        file.seek((max(head[0], 1) - 1) * _BLOCK_BYTES + _PROCESSOR)
        processor = file.read(1)
    if len(head) < _HEAD_BYTES or processor not in _LITTLE_ENDIAN:
        return None
    first, last = struct.unpack_from("<HH", head, _FRAMES)
    return last - first + 1 if first <= last < _UNKNOWN_FRAME else None


def _recording(path: Path, file: Any) -> RawRecording:
    point: Mapping[str, Any] = file["parameters"]["POINT"]
    points: Floats = np.moveaxis(np.asarray(file["data"]["points"][:3], dtype=np.float64), 0, 2)
    points = np.ascontiguousarray(np.swapaxes(points, 0, 1))
    labels = tuple(str(label).strip() for label in _values(point, "LABELS", "LABELS2", "LABELS3"))
    n = points.shape[1]
    labels = (*labels[:n], *(f"*{k + 1}" for k in range(len(labels), n)))
    rate_hz = float(next(iter(_values(point, "RATE")), 0.0))
    if len(points) == 0 or n == 0 or not rate_hz > 0.0:
        raise DataError(f"{path}: {len(points)} frames of {n} points at {rate_hz:g} Hz, expected some of each")
    residual = file["data"]["meta_points"]["residuals"][0].T if "meta_points" in file["data"] else None
    if residual is not None and residual.shape == points.shape[:2]:
        points[residual < 0.0] = np.nan  # what the C3D standard calls invalid
    computed = {str(label).strip() for group in _COMPUTED for label in _values(point, group)}
    rates = {"the header's frame rate": float(file["header"]["points"]["frame_rate"])}
    forces, analog_hz = _forces(file), _analog_rate(file)
    n_analog = file["data"]["analogs"].shape[2]
    if analog_hz > 0.0 and n_analog:
        rates["the analog channels' samples a frame"] = analog_hz * len(points) / n_analog
    unit = str(next(iter(_values(point, "UNITS")), ""))
    up = _up(str(next(iter(_values(point, "Y_SCREEN")), "")))
    return RawRecording(str(path), rate_hz, unit, labels, points, None, up, frozenset(computed), rates, forces)


def _values(group: Mapping[str, Any], *names: str) -> list[Any]:
    return [value for name in names if name in group for value in np.ravel(group[name]["value"]).tolist()]


def _up(screen: str) -> str:
    """Return the axis that points up on the screen, such as ``+z``."""
    text = screen.strip().lower()
    return text if len(text) == 2 and text[0] in "+-" and text[1] in "xyz" else ""


def _analog_rate(file: Any) -> float:
    return float(next(iter(_values(file["parameters"].get("ANALOG", {}), "RATE")), 0.0))


def _forces(file: Any) -> tuple[ForceRecord, ...]:
    """Return the force platforms' channels as they were stored."""
    platform = file["parameters"].get("FORCE_PLATFORM", {})
    used = int(next(iter(_values(platform, "USED")), 0))
    analogs: Floats = np.asarray(file["data"]["analogs"][0], dtype=np.float64)
    if not used or "CHANNEL" not in platform or not analogs.size:
        return ()
    channels = np.atleast_2d(np.asarray(platform["CHANNEL"]["value"], dtype=np.int64))
    records = []
    for k in range(min(used, channels.shape[1])):
        own = channels[:, k][(channels[:, k] > 0) & (channels[:, k] <= len(analogs))] - 1
        if len(own):
            records.append(ForceRecord(f"plate {k + 1}", _analog_rate(file), analogs[own].T))
    return tuple(records)
