"""A recording is read while it is written: every message once, at every moment no more than is whole."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocol.message import FRAMES, RAW, TRIAL, encode
from protocol.recording import RecordingWriter
from protocol.recording_files import numbered
from protocol.recording_follower import RecordingFollower

TOPICS = (FRAMES, TRIAL)


def write(writer, numbers):
    for number in numbers:
        for topic in (RAW, FRAMES, TRIAL) if number % 3 == 0 else (RAW, FRAMES):
            writer.write(topic, encode(topic, {"seq": number})[1], number)


def expected(numbers):
    return [(t, n) for n in numbers for t in (FRAMES, TRIAL) if t == FRAMES or n % 3 == 0]


def drained(follower):
    found = []
    while (message := follower.next()) is not None:
        found.append((message[0], message[1]["seq"]))
    return found


@pytest.fixture
def path(tmp_path):
    return tmp_path / "arm-12345678.mcap"


def test_what_was_flushed_can_be_read_while_more_is_written(path):
    now = [0.0]
    with RecordingWriter(path, "", "", clock=lambda: now[0]) as writer:
        follower = RecordingFollower(path, TOPICS)
        assert follower.found and drained(follower) == []
        write(writer, range(10))
        now[0] = 2.0
        writer.poll()
        assert follower.next()[1]["seq"] == 0  # and the others stay for later
        write(writer, range(10, 20))
        assert drained(follower) == expected(range(10))[1:]
        now[0] = 4.0
        writer.poll()
        assert drained(follower) == expected(range(10, 20))
        write(writer, range(20, 25))
    assert drained(follower) == expected(range(20, 25))
    assert drained(follower) == []
    follower.close()


def test_further_files_are_read_after_the_first(path):
    follower = RecordingFollower(path, TOPICS)
    assert not follower.found and follower.next() is None
    with RecordingWriter(path, "", "") as writer:
        write(writer, range(5))
        assert drained(follower) == []
    with RecordingWriter(numbered(path, 2), "", "") as writer:
        write(writer, range(5, 9))
    assert drained(follower) == expected(range(9))
    with RecordingWriter(numbered(path, 3), "", "") as writer:
        write(writer, range(9, 12))
    assert drained(follower) == expected(range(9, 12))
    follower.close()
    late = RecordingFollower(numbered(path, 3), TOPICS)  # the last one's name is enough
    assert drained(late) == expected(range(12))
    late.close()


def test_a_file_that_grows_byte_by_byte(path, tmp_path_factory):
    with RecordingWriter(path, "arm", "config") as writer:
        write(writer, range(6))
        writer._sync()
        write(writer, range(6, 9))
    whole = path.read_bytes()

    @given(st.lists(st.integers(0, len(whole)), max_size=8).map(sorted))
    def check(ends):
        growing = tmp_path_factory.mktemp("growing") / path.name
        growing.write_bytes(b"")
        follower, found = RecordingFollower(growing, TOPICS), []
        for end in (*ends, len(whole)):
            growing.write_bytes(whole[:end])
            found += drained(follower)
        follower.close()
        assert found == expected(range(9))

    check()


def test_what_is_no_recording_holds_nothing(path):
    path.write_bytes(b"no recording, but long enough to have a beginning" * 100)
    follower = RecordingFollower(path, TOPICS)
    assert follower.found and follower.next() is None
    follower.close()
