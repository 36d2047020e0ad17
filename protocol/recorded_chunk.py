"""A chunk of a recording, opened in bounded memory: it becomes no longer than it says, and that has a limit."""

import zlib
from collections.abc import Iterator
from io import BytesIO

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message

#: Bytes that a chunk may become: four times the largest message, and what others write has some.
MAX_CHUNK_BYTES = 64 * 1024 * 1024


def chunk_records(chunk: Chunk) -> Iterator[Channel | Message]:
    """Yield the channels and messages in a chunk, one at a time: a short message takes many times its bytes.

    Raises
    ------
    ValueError
        If it would become longer than a chunk may, is not as long as it says, or is damaged; among other errors
        of the library's.
    """
    if chunk.uncompressed_size > MAX_CHUNK_BYTES:
        raise ValueError(f"it would grow to {chunk.uncompressed_size} bytes, expected at most {MAX_CHUNK_BYTES}")
    data = _expanded(chunk)
    if len(data) != chunk.uncompressed_size:
        raise ValueError(f"it does not have the {chunk.uncompressed_size} bytes that it says")
    if chunk.uncompressed_crc not in (0, zlib.crc32(data)):
        raise ValueError("its checksum is another")
    stream = ReadDataStream(BytesIO(data))
    while stream.count < len(data):
        opcode, length = stream.read1(), stream.read8()
        if opcode == Opcode.MESSAGE:
            yield Message.read(stream, length)
        elif opcode == Opcode.CHANNEL:
            yield Channel.read(stream)
        else:  # a schema, which is not looked at, or what is not known
            stream.read(length)


def _expanded(chunk: Chunk) -> bytes:
    """Return what is in a chunk, or a byte more than there may be."""
    most = chunk.uncompressed_size + 1
    if chunk.compression == "zstd":
        with zstandard.ZstdDecompressor().stream_reader(chunk.data) as stream:
            return bytes(stream.read(most))
    if chunk.compression == "lz4":
        try:
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most))
        except RuntimeError as error:  # what the library raises at bytes that are none
            raise ValueError(f"it is no LZ4 ({error})") from error
    if chunk.compression:
        raise ValueError(f"its compression is {chunk.compression[:20]!r}, expected zstd or lz4")
    return chunk.data
