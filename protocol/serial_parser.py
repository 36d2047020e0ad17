"""Turns the bytes of the serial line back into frames, whatever happened to them on the way.

A length is believed only after the header's own CRC, so garbage never makes the parser wait for more than one
frame (65.6 kB). A frame whose payload fails its CRC is searched for the start of another: where bytes were
lost, the next good frame begins inside the span that the broken header claims.
"""

import zlib
from dataclasses import dataclass
from typing import NamedTuple

from limbcal.errors import ProtocolError
from protocol.device_info import DeviceInfo
from protocol.serial_frame import (
    HEADER,
    HEADER_BYTES,
    HEADER_CRC,
    KIND_INFO,
    KIND_SAMPLES,
    MAGIC,
    PAYLOAD_CRC,
    PAYLOAD_CRC_BYTES,
    VERSION,
    InfoFrame,
    SamplesFrame,
    SamplesRun,
    header_crc,
)
from protocol.serial_scan import NUMBER_AT, REST_AT, TICKS_AT, scan, warm_up

Frame = SamplesFrame | InfoFrame
#: What a parser finds: as many frames at once as follow each other alike.
Found = SamplesRun | InfoFrame


@dataclass
class ParserCounters:
    """What a parser has seen so far.

    Attributes
    ----------
    frames : int
        Good frames handed out.
    crc_errors : int
        Frames that were due where the line was in step, and whose header or payload failed its CRC; also
        payloads that failed after a good header anywhere.
    resyncs : int
        How often a good frame was found again at a place where none was due.
    discarded_bytes : int
        Bytes that belong to no good frame.
    wrong_version : int
        Whole frames of another protocol version.
    malformed : int
        Frames with right CRCs and contents that make no sense: unknown kind, sizes that contradict each
        other, an INFO that is not one.
    """

    frames: int = 0
    crc_errors: int = 0
    resyncs: int = 0
    discarded_bytes: int = 0
    wrong_version: int = 0
    malformed: int = 0


class _Like(NamedTuple):
    """What a frame of samples is like, number and clock apart: in a steady stream so are those that follow it."""

    begin: bytes
    rest: bytes
    size: int
    n_sample: int
    n_channel: int

    @classmethod
    def of(cls, block: bytes, position: int, size: int, n_sample: int, n_channel: int) -> "_Like":
        header = block[position : position + HEADER.size]
        return cls(header[:NUMBER_AT], header[REST_AT:], size, n_sample, n_channel)

    def is_at(self, block: bytes, position: int) -> bool:
        """Say whether what comes next seems to be such a frame."""
        whole = position + HEADER_BYTES <= len(block)
        return whole and block.startswith(self.begin, position) and block.startswith(self.rest, position + REST_AT)

    def run(self, block: bytes, position: int) -> SamplesRun | None:
        """Return such frames from here on, if there is a good one."""
        ticks, counts = scan(block, position, self.size, self.n_sample, self.n_channel, good=False)
        if not ticks:
            return None
        number = int.from_bytes(block[position + NUMBER_AT : position + TICKS_AT], "little")
        return SamplesRun(number, ticks, counts)


class FrameParser:
    """Parses a byte stream block by block; the frames are the same however the stream is cut into blocks.

    Sequence numbers are handed on as they came (they wrap at 2**32): accounting for gaps is the reader's.

    Attributes
    ----------
    counters : ParserCounters
    last_error : str or None
        The last sentence on a frame of another version or without sense, for the log.
    """

    def __init__(self) -> None:
        self.counters = ParserCounters()
        self.last_error: str | None = None
        self._pending = bytearray()
        self._need = HEADER_BYTES  # bytes without which nothing more can be said
        self._offset = 0  # place in the stream of the first pending byte
        self._due = 0  # place in the stream where a frame is due, if the stream is in step
        self._like: _Like | None = None  # what the last frame of samples was like
        warm_up()  # no byte is to wait for a compiler

    @property
    def pending_bytes(self) -> int:
        """Bytes held back until the frame they may belong to is complete; less than one frame."""
        return len(self._pending)

    def feed(self, data: bytes | bytearray | memoryview) -> list[Frame]:
        """Take the next bytes of the stream and return the frames that they complete, in order."""
        found = self.feed_runs(data)
        return [frame for one in found for frame in (one.frames() if isinstance(one, SamplesRun) else [one])]

    def feed_runs(self, data: bytes | bytearray | memoryview) -> list[Found]:
        """Do what `feed` does, without taking runs of frames apart."""
        if len(self._pending) + len(data) < self._need:
            self._pending += data
            return []
        block = b"".join((self._pending, data))
        found, used = self._parse(block)
        self._pending = bytearray(block[used:])
        self._offset += used
        return found

    def reset(self) -> None:
        """Forget the bytes held back, as after a reconnect; the next byte fed should begin a frame."""
        self.counters.discarded_bytes += len(self._pending)
        self._offset += len(self._pending)
        self._pending.clear()
        self._need = HEADER_BYTES
        self._due = self._offset

    def _parse(self, block: bytes) -> tuple[list[Found], int]:
        """Return the frames in a block and how many of its bytes are done with."""
        counters, view = self.counters, memoryview(block)
        found: list[Found] = []
        position, end = 0, len(block)
        self._need = HEADER_BYTES
        while True:
            if (like := self._steady(block, position)) is not None:
                if position + like.size > end and _header_crc_good(block, position):
                    self._need = like.size
                    return found, position
                if run := like.run(block, position):
                    position = self._note(run, found, position, like.size)
                    continue
            position = self._hunt(block, position)
            payload_start = position + HEADER_BYTES
            if payload_start > end:
                return found, position
            due = self._offset + position == self._due
            if not self._header_good(block, view[position : position + HEADER.size], position, due):
                position = self._skip_magic(position)
                continue
            _, version, kind, sequence, ticks, n_sample, n_channel, size = HEADER.unpack_from(block, position)
            payload_end = payload_start + size
            frame_end = payload_end + PAYLOAD_CRC_BYTES
            if frame_end > end:
                self._need = frame_end - position
                return found, position
            payload = view[payload_start:payload_end]
            if zlib.crc32(payload) != PAYLOAD_CRC.unpack_from(block, payload_end)[0]:
                counters.crc_errors += 1
                position = self._skip_magic(position)
                if due:  # if only bits were turned, the next frame is where this header says
                    self._due = self._offset + frame_end
                continue
            counters.resyncs += not due
            if version == VERSION and kind == KIND_SAMPLES:
                frame_bytes = frame_end - position
                run = SamplesRun(sequence, *scan(block, position, frame_bytes, n_sample, n_channel))
                self._like = _Like.of(block, position, frame_bytes, n_sample, n_channel)
                position = self._note(run, found, position, frame_bytes)
                continue
            info = self._info_frame(version, sequence, ticks, bytes(payload))
            if info is None:
                counters.discarded_bytes += frame_end - position
            else:
                counters.frames += 1
                found.append(info)
            position = frame_end
            self._due = self._offset + position

    def _steady(self, block: bytes, position: int) -> _Like | None:
        """Return what the last samples were like, if a frame is due here that seems to be like them."""
        due = self._offset + position == self._due
        return self._like if due and self._like is not None and self._like.is_at(block, position) else None

    def _note(self, run: SamplesRun, found: list[Found], position: int, size: int) -> int:
        """Add a run of frames of some size; return where it ends."""
        self.counters.frames += len(run.ticks)
        found.append(run)
        position += len(run.ticks) * size
        self._due = self._offset + position
        return position

    def _hunt(self, block: bytes, position: int) -> int:
        """Return where the next magic begins, or may begin with what is still to come."""
        while True:
            if position == self._due - self._offset:
                if position + HEADER_BYTES > len(block):
                    return position
                self._judge_magic(block, position)
            start = block.find(MAGIC, position)
            if start < 0:
                start = len(block)
                if start > position and block[-1] == MAGIC[0]:
                    start -= 1
            due = self._due - self._offset  # a frame that is due on the way there is looked at, too
            reached = due if position < due < start else start
            self.counters.discarded_bytes += reached - position
            if reached == start:
                return start
            position = reached

    def _judge_magic(self, block: bytes, position: int) -> None:
        """Count a frame that is due and whose magic alone is damaged: nothing else would tell of it."""
        covered = block[position : position + HEADER.size]
        if covered[: len(MAGIC)] == MAGIC:
            return
        (crc,) = HEADER_CRC.unpack_from(block, position + HEADER.size)
        if header_crc(MAGIC + covered[len(MAGIC) :]) == crc:
            size = HEADER.unpack(covered)[-1]
            self.counters.crc_errors += 1
            self._due += HEADER_BYTES + size + PAYLOAD_CRC_BYTES

    def _header_good(self, block: bytes, covered: memoryview, position: int, due: bool) -> bool:
        if not _header_crc_good(block, position):
            self.counters.crc_errors += due
            return False
        _, version, kind, _, _, n_sample, n_channel, size = HEADER.unpack_from(covered)
        if version == VERSION and not _plausible(kind, n_sample, n_channel, size):
            self._reject(f"kind {kind} with {n_sample} samples of {n_channel} channels in {size} bytes")
            return False
        return True

    def _skip_magic(self, position: int) -> int:
        self.counters.discarded_bytes += len(MAGIC)
        return position + len(MAGIC)

    def _info_frame(self, version: int, sequence: int, ticks: int, payload: bytes) -> InfoFrame | None:
        if version != VERSION:
            self.counters.wrong_version += 1
            self.last_error = f"serial frame {sequence}: version {version}, expected {VERSION}"
            return None
        try:
            return InfoFrame(sequence, ticks, DeviceInfo.from_json(payload))
        except ProtocolError as error:
            self._reject(str(error))
            return None

    def _reject(self, found: str) -> None:
        self.counters.malformed += 1
        self.last_error = f"serial frame: {found}"


def _header_crc_good(block: bytes, position: int) -> bool:
    (crc,) = HEADER_CRC.unpack_from(block, position + HEADER.size)
    return bool(header_crc(block[position : position + HEADER.size]) == crc)


def _plausible(kind: int, n_sample: int, n_channel: int, size: int) -> bool:
    if kind == KIND_SAMPLES:
        return size == 2 * n_sample * n_channel > 0
    return kind == KIND_INFO and size > 0
