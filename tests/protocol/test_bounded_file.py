"""Lengths that lie cost no memory."""

import os
import resource
import struct
from pathlib import Path
from typing import IO

import pytest

from protocol.bounded_file import bounded
from protocol.message import GAP
from protocol.recording_follower import RecordingFollower
from protocol.recording_reader import MAGIC, read_recording, recording_attachments


@pytest.mark.parametrize("length", [10, 100_000, 2**32])
def test_it_reads_what_is_left(tmp_path: Path, length: int) -> None:
    (tmp_path / "x").write_bytes(bytes(70_000))
    with (tmp_path / "x").open("rb") as file:
        assert len(bounded(file).read(length)) == min(length, 70_000)
        assert len(bounded(file).read(length)) == min(length, 70_000 - min(length, 70_000))


def test_little_is_read_without_a_look_at_the_file() -> None:
    """A pipe has no length; what is read of it may be little, and is."""
    reading, writing = os.pipe()
    os.write(writing, b"some bytes")
    with os.fdopen(reading, "rb") as file, os.fdopen(writing, "wb"):
        assert bounded(file).read(4) == b"some"


@pytest.mark.parametrize("opcode", [0x01, 0x03, 0x06, 0x09])  # header, schema, chunk, attachment
def test_a_text_of_gigabytes_inside_a_small_record(tmp_path: Path, opcode: int) -> None:
    """As the fuzzer found: the record's own length is checked, and not those of what is in it."""
    path = tmp_path / "x.mcap"
    body = bytes(16 if opcode == 0x09 else 2 if opcode == 0x03 else 0) + struct.pack("<I", 0xC929_DD93) + bytes(64)
    path.write_bytes(MAGIC + bytes([opcode]) + struct.pack("<Q", len(body)) + body)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert list(read_recording(path)) == []
    assert recording_attachments(path) == {} or opcode == 0x09
    follower = RecordingFollower(path, (GAP,))
    assert follower.next() is None
    follower.close()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 64 * 1024


@pytest.mark.parametrize(
    ("length", "asked"), [(65_536, 65_536), (65_537, 65_537), (70_001, 70_000), (2**40, 70_000)]
)
def test_more_than_a_little_is_asked_for_only_where_it_is_there(tmp_path: Path, length: int, asked: int) -> None:
    (tmp_path / "x").write_bytes(bytes(70_000))

    class Noting:
        """A file that notes what it is asked for."""

        def __init__(self, file: IO[bytes]) -> None:
            self.file, self.asked = file, list[int]()
            self.fileno, self.tell = file.fileno, file.tell

        def read(self, length: int) -> bytes:
            self.asked.append(length)
            return self.file.read(length)

    with (tmp_path / "x").open("rb") as file:
        noting = Noting(file)
        assert len(bounded(noting).read(length)) == asked  # type: ignore[arg-type]
        file.seek(80_000)
        assert bounded(noting).read(length) == b""  # type: ignore[arg-type]
    assert noting.asked == [asked, 65_536 if length == 65_536 else 0]


def test_little_is_asked_for_without_asking_how_much_there_is() -> None:
    class Endless:
        def read(self, length: int) -> bytes:
            return bytes(length)

    assert len(bounded(Endless()).read(65_536)) == 65_536  # type: ignore[arg-type]
