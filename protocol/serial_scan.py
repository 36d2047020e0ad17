"""Frames of samples that follow one another, checked and taken out in one go: compiled.

A line in step brings hundreds of frames a second that differ in nothing but their number, their clock and their
samples. The first of them is parsed; those after it need only be held against it.
"""

import binascii
from functools import cache

import numpy as np
from numpy.typing import NDArray

from limbcal.compiled import compiled
from protocol.serial_frame import HEADER, HEADER_BYTES, PAYLOAD_CRC_BYTES, encode_samples

Bytes = NDArray[np.uint8]

#: Where a header has its number and its clock.
NUMBER_AT, TICKS_AT, REST_AT = 4, 8, 16
_CRC_AT, _FIRST_CRC_16, _ALL_ONES = HEADER.size, 0xFFFF, 0xFFFFFFFF
#: What CRC-16/CCITT-FALSE makes of one more byte.
_CRC_16 = np.array([binascii.crc_hqx(bytes([byte]), 0) for byte in range(256)], dtype=np.uint16)


def _crc_32_tables() -> NDArray[np.uint32]:
    """Return what CRC-32 makes of a byte with 0 to 7 others after it (M. Kounavis, F. Berry, ISCC 2005)."""
    tables = np.zeros((8, 256), dtype=np.uint32)
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xEDB88320 if crc & 1 else 0)
        tables[0, byte] = crc
    for others in range(1, 8):
        before = tables[others - 1]
        tables[others] = tables[0][before & 0xFF] ^ before >> 8
    return tables


_CRC_32 = _crc_32_tables()


def scan(
    block: bytes, start: int, size: int, n_sample: int, n_channel: int, good: bool = True
) -> tuple[list[int], NDArray[np.int16]]:
    """Take out a frame of samples and the good ones right after it that are laid out and numbered on alike.

    Parameters
    ----------
    block : bytes
    start, size : int
        Where in the block the first frame is, and its bytes.
    n_sample, n_channel : int
        What is in it.
    good : bool
        The first frame's checksums are known to be right; otherwise nothing is taken out if they are not.

    Returns
    -------
    ticks : list of int
        The clock of each frame.
    counts : (len(ticks) * n_sample, n_channel) int16
    """
    most = (len(block) - start) // size
    ticks = np.empty(most, dtype=np.uint64)
    counts = np.empty((most * n_sample, n_channel), dtype=np.int16)
    n = _scan(np.frombuffer(block, np.uint8), start, size, ticks, counts.reshape(-1), good)
    return ticks[:n].tolist(), counts[: n * n_sample]


@cache
def warm_up() -> None:
    """Have the kernel compiled."""
    frame = encode_samples(np.zeros((1, 1), dtype=np.int16), 0, 0)
    scan(frame, 0, len(frame), 1, 1)


@compiled
def _scan(
    block: Bytes, start: int, size: int, ticks: NDArray[np.uint64], counts: NDArray[np.int16], good: bool
) -> int:
    first = block[start : start + size]
    begin, end = HEADER_BYTES, size - PAYLOAD_CRC_BYTES
    n_count = (end - begin) // 2
    number = _little(first, NUMBER_AT, TICKS_AT)
    for k in range(ticks.size):
        frame = block[start + k * size : start + (k + 1) * size]
        if not (k == 0 and good) and not (
            _little(frame, NUMBER_AT, TICKS_AT) == (number + k) & _ALL_ONES
            and _alike(frame, first)
            and _crc_16(frame[:_CRC_AT]) == _little(frame, _CRC_AT, begin)
            and _crc_32(frame[begin:end]) == _little(frame, end, size)
        ):
            return k
        ticks[k] = _little(frame, TICKS_AT, REST_AT)
        for i in range(n_count):
            value = np.uint16(frame[begin + 2 * i]) | np.uint16(frame[begin + 2 * i + 1]) << np.uint16(8)
            counts[k * n_count + i] = np.int16(value)
    return int(ticks.size)


@compiled
def _alike(frame: Bytes, first: Bytes) -> bool:
    """Say whether a header is another's but for its number and its clock."""
    for i in range(_CRC_AT):
        if not NUMBER_AT <= i < REST_AT and frame[i] != first[i]:
            return False
    return True


@compiled
def _little(frame: Bytes, begin: int, end: int) -> np.uint64:
    value = np.uint64(0)
    for i in range(end - begin):
        value |= np.uint64(frame[begin + i]) << np.uint64(8 * i)
    return value


@compiled
def _crc_16(data: Bytes) -> np.uint64:
    crc = np.uint64(_FIRST_CRC_16)
    for byte in data:
        crc = np.uint64(_CRC_16[crc >> np.uint64(8) ^ np.uint64(byte)]) ^ crc << np.uint64(8) & np.uint64(0xFF00)
    return crc


@compiled
def _crc_32(data: Bytes) -> np.uint64:
    """Return CRC-32, eight bytes a step."""
    crc = np.uint32(_ALL_ONES)
    eights = data.size // 8
    for k in range(eights):
        at = 8 * k
        crc = (
            _CRC_32[7, np.uint8(crc) ^ data[at]]
            ^ _CRC_32[6, np.uint8(crc >> np.uint32(8)) ^ data[at + 1]]
            ^ _CRC_32[5, np.uint8(crc >> np.uint32(16)) ^ data[at + 2]]
            ^ _CRC_32[4, np.uint8(crc >> np.uint32(24)) ^ data[at + 3]]
            ^ _CRC_32[3, data[at + 4]]
            ^ _CRC_32[2, data[at + 5]]
            ^ _CRC_32[1, data[at + 6]]
            ^ _CRC_32[0, data[at + 7]]
        )
    for i in range(8 * eights, data.size):
        crc = _CRC_32[0, np.uint8(crc) ^ data[i]] ^ crc >> np.uint32(8)
    return np.uint64(crc ^ np.uint32(_ALL_ONES))
