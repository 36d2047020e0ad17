"""The parser against garbage, turned bits, lost bytes, and every way to cut a stream."""

import struct
import zlib
from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import (
    MAGIC,
    InfoFrame,
    encode_info,
    encode_samples,
    header_crc,
)
from protocol.serial_parser import FrameParser

INFO = DeviceInfo("limb-x", "0007", "1.2.3", 32000.0, 1e6, (Channel("s1x", 0.0015, 0.0, 49.0),))
LONGEST = 24 + 0xFFFF + 4
FrameParser()  # compiled before hypothesis looks at the time


def samples(sequence, n_sample=4, n_channel=3):
    rng = np.random.default_rng(sequence)
    block = rng.integers(-(2**15), 2**15, (n_sample, n_channel), dtype=np.int16)
    return encode_samples(block, sequence, 1000 * sequence)


def header(kind=2, n_sample=1, n_channel=1, size=2, version=1, sequence=0):
    covered = struct.pack("<2sBBIQHHH", MAGIC, version, kind, sequence, 0, n_sample, n_channel, size)
    return covered + struct.pack("<H", header_crc(covered))


def whole(payload, **fields):
    return header(size=len(payload), **fields) + payload + struct.pack("<I", zlib.crc32(payload))


def encoded(frame):
    """Return a parsed frame as the bytes that it came from."""
    if isinstance(frame, InfoFrame):
        return encode_info(frame.info, frame.sequence, frame.ticks)
    return encode_samples(frame.counts, frame.sequence, frame.ticks)


def parse(stream, cuts=()):
    parser, found = FrameParser(), []
    edges = [0, *sorted(cuts), len(stream)]
    for start, stop in zip(edges, edges[1:], strict=False):
        found += parser.feed(stream[start:stop])
    good = [encoded(frame) for frame in found]
    counters = parser.counters
    assert counters.frames == len(good)
    # every byte is accounted for
    assert sum(map(len, good)) + counters.discarded_bytes + parser.pending_bytes == len(stream)
    return good, counters


good_frames = st.one_of(
    st.builds(samples, st.integers(0, 2**32 - 1), st.integers(1, 33), st.integers(1, 12)),
    st.builds(encode_info, st.just(INFO), st.integers(0, 2**32 - 1), st.integers(0, 2**64 - 1)),
)


@st.composite
def beginnings(draw):
    """Return the beginning of a frame, as when a cable is pulled."""
    frame = draw(good_frames)
    return frame[: draw(st.integers(0, len(frame) - 5))]


garbage = st.one_of(
    st.binary(max_size=100),
    beginnings(),
    st.integers(1, 20).map(lambda n: MAGIC * n),
    st.just(MAGIC[:1]),
    st.just(header(size=2, n_sample=1)),  # a right header, and then nothing of the kind
    st.just(header(n_sample=32767, size=65534)),
)


@given(st.lists(good_frames, max_size=8))
def test_clean_stream(frames):
    found, counters = parse(b"".join(frames))
    assert found == frames
    assert asdict(counters) == {**dict.fromkeys(asdict(counters), 0), "frames": len(frames)}


@given(st.lists(st.one_of(good_frames, garbage), max_size=8).map(b"".join), st.data())
def test_chunking_makes_no_difference(stream, data):
    cuts = data.draw(st.lists(st.integers(0, len(stream)), max_size=20))
    found, counters = parse(stream)
    for other in (cuts, range(1, len(stream))):
        again, counted = parse(stream, other)
        assert again == found
        # of garbage at the end more may be held back; `parse` has accounted for it
        assert replace(counted, discarded_bytes=counters.discarded_bytes) == counters


@given(st.lists(st.tuples(garbage, good_frames), min_size=1, max_size=6))
def test_garbage_between_frames_loses_no_frame(pairs):
    stream = b"".join(noise + frame for noise, frame in pairs)
    found, counters = parse(stream + bytes(LONGEST))  # a false header waits for one frame's length at most
    assert found == [frame for _, frame in pairs]
    assert counters.resyncs <= len(pairs)
    assert counters.discarded_bytes == sum(len(noise) for noise, _ in pairs) + LONGEST


@given(st.lists(good_frames, min_size=1, max_size=5), st.data())
def test_a_turned_bit_in_a_payload_costs_one_frame(frames, data):
    struck = data.draw(st.integers(0, len(frames) - 1))
    broken = bytearray(frames[struck])
    broken[data.draw(st.integers(24, len(broken) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    found, counters = parse(b"".join([*frames[:struck], bytes(broken), *frames[struck + 1 :]]) + bytes(24))
    assert found == frames[:struck] + frames[struck + 1 :]
    assert counters.crc_errors == 1
    assert counters.resyncs == 0  # the next frame was where it was due
    assert counters.discarded_bytes == len(broken) + 24


@given(st.lists(good_frames, min_size=2, max_size=5), st.data())
def test_a_turned_bit_in_a_header_costs_one_frame(frames, data):
    struck = data.draw(st.integers(0, len(frames) - 2))
    broken = bytearray(frames[struck])
    place = data.draw(st.integers(0, 23))
    broken[place] ^= 1 << data.draw(st.integers(0, 7))
    found, counters = parse(b"".join([*frames[:struck], bytes(broken), *frames[struck + 1 :]]))
    assert found == frames[:struck] + frames[struck + 1 :]
    assert counters.crc_errors == 1
    assert counters.resyncs == (place >= len(MAGIC))  # where only the magic is hit, the header says what follows


@given(st.lists(good_frames, min_size=3, max_size=5), st.data())
def test_lost_bytes_cost_the_frame_they_were_lost_from(frames, data):
    struck = data.draw(st.integers(0, len(frames) - 2))
    frame = frames[struck]
    start = data.draw(st.integers(0, len(frame) - 5))
    stop = data.draw(st.integers(start + 4, len(frame)))
    stream = b"".join([*frames[:struck], frame[:start], frame[stop:], *frames[struck + 1 :]])
    found, counters = parse(stream + bytes(LONGEST))
    assert found == frames[:struck] + frames[struck + 1 :]


def test_an_absurd_length_is_not_believed_without_its_crc():
    absurd = bytearray(header(n_sample=32767, size=65534))
    absurd[22] ^= 1
    found, counters = parse(bytes(absurd) + samples(1))
    assert found == [samples(1)]  # at once, with no further bytes
    assert counters.crc_errors == 1
    assert counters.resyncs == 1


@pytest.mark.parametrize(
    "false",
    [
        header(kind=2, n_sample=32, n_channel=12, size=65535),
        header(kind=2, n_sample=0, n_channel=12, size=0),
        header(kind=1, n_sample=0, n_channel=12, size=0),
        header(kind=9, size=65535),
    ],
)
def test_a_header_that_contradicts_itself_is_not_waited_for(false):
    found, counters = parse(false + samples(1))
    assert found == [samples(1)]
    assert counters.malformed == 1


def test_the_wait_for_a_false_header_is_bounded():
    parser = FrameParser()
    parser.feed(header(n_sample=32767, size=65534))
    fed, found = 0, []
    while not found:
        found = parser.feed(samples(7))
        fed += len(samples(7))
        assert parser.pending_bytes < LONGEST
    assert fed <= LONGEST + len(samples(7))
    assert {encoded(frame) for frame in found} == {samples(7)}
    assert len(found) == fed // len(samples(7))  # not one of those behind it was lost


def test_another_version_is_counted_and_passed_over():
    parser = FrameParser()
    (frame,) = parser.feed(whole(b"new world", version=2, sequence=41) + samples(1))
    assert encoded(frame) == samples(1)
    assert parser.counters.wrong_version == 1
    assert parser.counters.resyncs == parser.counters.crc_errors == 0
    assert parser.last_error == "serial frame 41: version 2, expected 1"


def test_an_info_without_sense_is_counted_and_said():
    parser = FrameParser()
    (frame,) = parser.feed(whole(b'{"device": 1}', kind=1) + samples(1))
    assert encoded(frame) == samples(1)
    assert parser.counters.malformed == 1
    assert "channels is missing" in parser.last_error


def test_reset_forgets_half_a_frame():
    parser = FrameParser()
    assert parser.feed(samples(1)[:50]) == []
    parser.reset()
    (frame,) = parser.feed(samples(2))
    assert encoded(frame) == samples(2)
    assert parser.counters.discarded_bytes == min(50, len(samples(1)))
    assert parser.counters.resyncs == parser.counters.crc_errors == 0


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_any_bytes_are_taken(kind):
    assert len(FrameParser().feed(kind(samples(1)))) == 1


def test_frames_outlive_the_block_they_came_in():
    block = bytearray(samples(1))
    (frame,) = FrameParser().feed(block)
    block[:] = bytes(len(block))
    assert encoded(frame) == samples(1)


@settings(max_examples=30)
@given(st.binary(max_size=3000))
def test_nothing_is_raised_and_little_is_held_back(noise):
    parser = FrameParser()
    parser.feed(noise)
    assert parser.pending_bytes < LONGEST


class WorkCounter(FrameParser):
    """Counts the bytes that are looked at: time that no busy machine can stretch."""

    looked_at = 0

    def _parse(self, block):
        self.looked_at += len(block)
        return super()._parse(block)


@pytest.mark.parametrize("block_bytes", [1 << 12, 1 << 24])
def test_10_megabytes_are_looked_at_once_and_in_runs(block_bytes):
    stream = b"".join(samples(k, 32, 12) for k in range(100)) * 130  # a second at the fastest
    parser = WorkCounter()
    starts = range(0, len(stream), block_bytes)
    runs = [run for start in starts for run in parser.feed_runs(stream[start : start + block_bytes])]
    assert parser.counters.frames == 13_000
    assert parser.looked_at < 1.25 * len(stream)  # less than a frame of each block is seen again
    assert len(runs) <= 130 + len(starts)  # Python is entered once a run, not once a frame


def test_a_long_frame_byte_by_byte_is_looked_at_when_it_is_whole():
    stream = samples(1, 2730, 12)
    parser = WorkCounter()
    found = [frame for k in range(len(stream)) for frame in parser.feed(stream[k : k + 1])]
    assert len(found) == 1
    assert parser.looked_at <= 2 * len(stream)


@pytest.mark.parametrize("cut", [None, 40, 52, 53, 76, 100])
def test_a_damaged_magic_behind_a_damaged_frame_is_counted(cut):
    """The hunt for the next magic starts before the place where a frame is due, and must not run past it."""
    one, two, three = (bytearray(samples(k)) for k in (1, 2, 3))
    one[30] ^= 1
    two[0] ^= 1
    good, counters = parse(bytes(one + two + three), [] if cut is None else [cut])
    assert good == [bytes(three)]
    assert counters.crc_errors == 2


def test_a_damaged_magic_is_counted_however_far_the_stream_has_come():
    one, two, three = (bytearray(samples(k)) for k in (1, 2, 3))
    one[30] ^= 1
    two[0] ^= 1
    parser = FrameParser()
    for k in range(10, 20):
        assert len(parser.feed(samples(k))) == 1
    assert [encoded(frame) for frame in parser.feed(bytes(one + two + three))] == [bytes(three)]
    assert (parser.counters.crc_errors, parser.counters.frames) == (2, 11)
    assert (parser.counters.resyncs, parser.pending_bytes) == (0, 0)
    assert parser.counters.discarded_bytes == len(one) + len(two)


@pytest.mark.parametrize(("end", "held"), [(b"", 0), (MAGIC[:1], 1), (MAGIC[1:], 0), (2 * MAGIC[:1], 1)])
def test_of_garbage_only_what_may_begin_a_magic_is_held_back(end, held):
    parser = FrameParser()
    assert parser.feed(bytes(50) + end) == []
    assert (parser.pending_bytes, parser.counters.discarded_bytes) == (held, 50 + len(end) - held)
