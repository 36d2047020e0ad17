"""Frames taken out in one go are those that a parser would find one by one."""

import binascii
import zlib

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from protocol.serial_frame import SEQUENCES, SamplesRun, encode_samples
from protocol.serial_parser import FrameParser
from protocol.serial_scan import _crc_16, _crc_32, scan, warm_up

warm_up()  # compiled before hypothesis looks at the time
N_SAMPLE, N_CHANNEL = 5, 3


def blocks(n: int) -> NDArray[np.int16]:
    rng = np.random.default_rng(n)
    return rng.integers(-(2**15), 2**15, (n, N_SAMPLE, N_CHANNEL), dtype=np.int16)


def encoded(n: int, first: int = 0, ticks: int = 0) -> list[bytes]:
    return [encode_samples(block, first + k, ticks + 7 * k) for k, block in enumerate(blocks(n))]


def scanned(stream: bytes, size: int) -> tuple[list[int], NDArray[np.int16]]:
    return scan(stream, 0, size, N_SAMPLE, N_CHANNEL)


@given(st.binary(max_size=100))
def test_checksums_are_those_of_the_frames(data: bytes) -> None:
    for check in (_crc_16, _crc_32):
        check(np.frombuffer(b"", np.uint8))  # compiled
    found = np.frombuffer(data, np.uint8)
    assert (int(_crc_16(found)), int(_crc_32(found))) == (binascii.crc_hqx(data, 0xFFFF), zlib.crc32(data))


@given(st.integers(1, 9), st.sampled_from([0, SEQUENCES - 3]), st.integers(0, 2**63), st.binary(max_size=30))
def test_frames_that_follow_are_taken_out(n: int, first: int, ticks: int, rest: bytes) -> None:
    frames = encoded(n, first, ticks)
    found, counts = scanned(b"".join(frames) + rest, len(frames[0]))
    assert found == [ticks + 7 * k for k in range(n)]
    np.testing.assert_array_equal(counts, blocks(n).reshape(-1, N_CHANNEL))


@given(st.data())
def test_a_turned_bit_ends_it(data: st.DataObject) -> None:
    frames = encoded(6)
    struck = data.draw(st.integers(1, 5))
    broken = bytearray(frames[struck])
    broken[data.draw(st.integers(0, len(broken) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    found, counts = scanned(b"".join([*frames[:struck], bytes(broken), *frames[struck + 1 :]]), len(frames[0]))
    assert (len(found), len(counts)) == (struck, struck * N_SAMPLE)


def test_another_number_or_layout_ends_it() -> None:
    one, two, three = encoded(3)
    assert len(scanned(one + three, len(one))[0]) == 1
    wider = encode_samples(np.zeros((N_CHANNEL, N_SAMPLE), dtype=np.int16), 1, 0)  # of the same size
    assert len(wider) == len(two)
    assert len(scanned(one + wider, len(one))[0]) == 1


@given(st.lists(st.integers(1, 5), max_size=4), st.lists(st.integers(0, 2000), max_size=6))
def test_a_parser_gives_runs_as_the_frames_that_they_are(lengths: list[int], cuts: list[int]) -> None:
    frames = [frame for k, n in enumerate(lengths) for frame in encoded(n, 100 * k, 1000 * k)]
    stream, runs, singles = b"".join(frames), FrameParser(), FrameParser()
    edges = [0, *sorted(min(cut, len(stream)) for cut in cuts), len(stream)]
    again: list[bytes] = []
    for begin, end in zip(edges, edges[1:], strict=False):
        found = [one for one in runs.feed_runs(stream[begin:end]) if isinstance(one, SamplesRun)]
        one_by_one = [frame for run in found for frame in run.frames()]
        again += [encode_samples(frame.counts, frame.sequence, frame.ticks) for frame in one_by_one]
        assert len(one_by_one) == len(singles.feed(stream[begin:end]))
    assert again == frames
    assert runs.counters == singles.counters
