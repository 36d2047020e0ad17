"""The doors at which bytes of others arrive, each with what may come of them."""

import zlib
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Protocol

import numpy as np

from daemon.config.config import load_setup
from limbcal.errors import ConfigError, DataError, ProtocolError
from protocol.device_info import Channel, DeviceInfo
from protocol.message import FRAMES, PLOT, RAW, decode, encode
from protocol.recording import RecordingWriter
from protocol.recording_reader import read_recording, recording_attachments
from protocol.serial_frame import InfoFrame, SamplesFrame, encode_info, encode_samples
from protocol.serial_parser import FrameParser
from tests.fuzz.sealed_frames import sealed

#: The longest frame there can be.
_FRAME_BYTES = 24 + 0xFFFF + 4
EXAMPLE = Path(__file__).parents[2] / "examples" / "limbd.toml"


class Door(Protocol):
    """Something that takes bytes."""

    def seeds(self) -> list[bytes]:
        """Return what usually comes."""

    def knock(self, data: bytes) -> None:
        """Take bytes; raises where something else comes of them than what may."""


class Frames:
    """The serial line. A first byte of 1 has the checksums of what follows put right, so that more is reached."""

    def __init__(self, folder: Path) -> None:
        """Need nothing."""

    def seeds(self) -> list[bytes]:
        info = DeviceInfo("device", "1", "1", 8000.0, 1e6, (Channel("s1x", 0.01, 0.0, 49.0),))
        counts = np.arange(64, dtype=np.int16)[:, None]
        blocks = (encode_samples(counts[16 * k : 16 * k + 16], k + 1, 2000 * k) for k in range(4))
        parts = [encode_info(info, 0, 5), *blocks]
        stream = b"".join(parts)
        return [b"\0" + stream, b"\1" + stream, b"\1" + parts[1] + b"\xa5\x5a" + parts[2][:40] + parts[3]]

    def knock(self, data: bytes) -> None:
        stream = sealed(data[1:]) if data[:1] == b"\1" else data[1:]
        whole, cut = FrameParser(), FrameParser()
        frames = whole.feed(stream)
        rng = np.random.default_rng(zlib.crc32(data))
        edges = [0, *sorted(rng.integers(0, len(stream) + 1, 3)), len(stream)]
        pieces = [frame for a, b in zip(edges, edges[1:], strict=False) for frame in cut.feed(stream[a:b])]
        assert len(frames) == len(pieces)
        for one, other in zip(frames, pieces, strict=True):
            assert again(one) == again(other)
            assert again(one) in stream or isinstance(one, InfoFrame)
        assert max(whole.pending_bytes, cut.pending_bytes) <= _FRAME_BYTES
        assert accounts(whole) == accounts(cut)


def accounts(parser: FrameParser) -> dict[str, int]:
    """Return the counters; bytes that are of no frame may still be held back, so the two are one."""
    counters = asdict(parser.counters)
    return {**counters, "discarded_bytes": counters["discarded_bytes"] + parser.pending_bytes}


def again(frame: SamplesFrame | InfoFrame) -> bytes:
    """Return a frame as it is sent."""
    if isinstance(frame, InfoFrame):
        return encode_info(frame.info, frame.sequence, frame.ticks)
    return encode_samples(frame.counts, frame.sequence, frame.ticks)


class Messages:
    """ZeroMQ: topic, a zero byte, payload."""

    def __init__(self, folder: Path) -> None:
        """Need nothing."""

    def seeds(self) -> list[bytes]:
        common = {"arm": "dd-arm", "run": "r", "seq": 3}
        block = {**common, "sample0": 1, "t0_ns": 10**18, "n": 2, "a": np.ones((2, 3), dtype=np.float32)}
        rows = {"rows": [{"ts": 1.5, "q1": 0.25}, {"ts": 2.0, "q1": 1e300}], "seq": 1}
        motion = {**common, "gap": True, "q": np.zeros((0, 2)), "nested": {"a": [1, {"b": None}]}}
        made = [encode(RAW, block), encode(PLOT, rows), encode(FRAMES, motion)]
        return [b"\0".join(parts) for parts in made]

    def knock(self, data: bytes) -> None:
        topic, _, payload = data.partition(b"\0")
        try:
            name, fields = decode([topic, payload])
        except ProtocolError:
            return
        assert isinstance(name, str) and all(isinstance(key, str) for key in fields)
        if name != PLOT:  # what was understood can be sent on
            assert encode(name, fields)[0] == topic


class Configs:
    """`limbd.toml`."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "limbd.toml"

    def seeds(self) -> list[bytes]:
        return [
            EXAMPLE.read_bytes(),
            b'[device]\nport = "x"\n[arm]\nfile = "dd-arm"\n[metrics]\naddress = "localhost:1"\n',
        ]

    def knock(self, data: bytes) -> None:
        self._path.write_bytes(data)
        try:
            setup = load_setup(self._path, {})
        except ConfigError as error:
            assert error.mistakes and all(mistake.strip() for mistake in error.mistakes)
            return
        assert setup.arm.sensors


class Recordings:
    """MCAP files."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "fuzzed.mcap"
        self._made = folder / "seed.mcap"

    def seeds(self) -> list[bytes]:
        seeds = []
        for n in (1, 4):
            self._made.unlink(missing_ok=True)
            with RecordingWriter(self._made, "arm", "config") as writer:
                for k in range(n):
                    writer.write(RAW, encode(RAW, {"arm": "a", "run": "r", "seq": k, "a": np.ones((2, 2))})[1], k)
            whole = self._made.read_bytes()
            seeds += [whole, whole[: len(whole) // 2]]
        return seeds

    def knock(self, data: bytes) -> None:
        self._path.write_bytes(data)
        try:
            recording_attachments(self._path)
            with read_recording(self._path) as messages:
                for topic, fields, _ in messages:
                    assert isinstance(topic, str) and isinstance(fields, dict)
        except (DataError, ProtocolError) as error:
            assert str(error).strip()


DOORS: dict[str, Callable[[Path], Door]] = {
    "frames": Frames,
    "messages": Messages,
    "configs": Configs,
    "recordings": Recordings,
}
