"""Checksums put right: what a fuzzer cannot guess and a broken device can send."""

import struct
import zlib

from protocol.serial_frame import HEADER_BYTES, MAGIC, PAYLOAD_CRC_BYTES, header_crc

_CRC_AT, _SIZE_AT = 22, 20


def sealed(stream: bytes) -> bytes:
    """Return a stream in which every header that there is room for has right checksums."""
    data, place = bytearray(stream), 0
    while (place := data.find(MAGIC, place)) >= 0 and place + HEADER_BYTES <= len(data):
        data[place + _CRC_AT : place + HEADER_BYTES] = struct.pack(
            "<H", header_crc(bytes(data[place : place + _CRC_AT]))
        )
        (size,) = struct.unpack_from("<H", data, place + _SIZE_AT)
        end = place + HEADER_BYTES + size
        if end + PAYLOAD_CRC_BYTES <= len(data):
            crc = zlib.crc32(bytes(data[place + HEADER_BYTES : end]))
            data[end : end + PAYLOAD_CRC_BYTES] = struct.pack("<I", crc)
            place = end + PAYLOAD_CRC_BYTES
        else:
            place += len(MAGIC)
    return bytes(data)
