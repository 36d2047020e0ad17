"""Whoever comes late, or misses messages in between, ends with the same as one who was there from the start."""

from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.live.complete_stream import CompleteStream
from limbcal.errors import ConfigError
from protocol.message import FRAMES, HEALTH, TRIAL, encode
from protocol.recording import RecordingWriter

RUN = "11111111-2222"
HEARTBEAT = 7


class Inbox:
    """Stands for what was received: messages, or None where nothing came in time."""

    def __init__(self, messages):
        self._messages = deque(messages)

    def __len__(self):
        return len(self._messages)

    def receive(self, _timeout_ms):
        return self._messages.popleft() if self._messages else None

    def stop(self):
        self._messages.clear()


class Clock:
    """Goes on by a tenth of a second whenever it is looked at."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        self.now += 0.1
        return self.now


def sent(count, recording, run=RUN):
    """Return what a daemon sends: frames, two announcements every tenth of them, and heartbeats."""
    last, messages = {}, []

    def send(topic, fields):
        last[topic] = last.get(topic, -1) + 1
        messages.append((topic, {**fields, "run": run, "seq": last[topic]}))

    for k in range(count):
        send(FRAMES, {"frame0": k, "last_seq": {TRIAL: last[TRIAL]} if TRIAL in last else {}})
        if k % 10 in (3, 8):
            state = "begin" if k % 10 == 3 else "end"
            send(TRIAL, {"trial": k // 10 + 1, "state": state, "last_seq": dict(last)})
        if k % HEARTBEAT == 0:
            send(HEALTH, {"last_seq": dict(last), "recording": recording})
    send(HEALTH, {"last_seq": dict(last), "recording": recording})
    return messages


def record(path, messages):
    with RecordingWriter(path, "", "") as writer:
        for topic, fields in messages:
            writer.write(topic, encode(topic, fields)[1], 0)


def followed(messages):
    """Return the numbers of frames and announcements as they were handed out, and the stream."""
    notes = []
    stream = CompleteStream(Inbox(messages), notes.append, Clock())
    found, vain = [], 0
    while stream.waits or vain < 2:
        message = stream.receive(0)
        vain = 0 if message is not None else vain + 1
        if message is not None and message[0] != HEALTH:
            found.append((message[0], message[1]["run"], message[1]["seq"]))
    stream.close()
    return found, stream, notes


def numbers(messages):
    return [(topic, fields["run"], fields["seq"]) for topic, fields in messages if topic != HEALTH]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "arm-11111111.mcap"


def test_a_stream_that_misses_nothing_is_handed_on(path):
    messages = sent(40, str(path))
    found, stream, notes = followed(messages)
    assert found == numbers(messages)
    assert (stream.missed, stream.recovered, notes) == ({}, 0, [])


def test_a_recorded_run_is_complete_whatever_was_missed(path):
    messages = sent(60, str(path))
    record(path, messages)

    @given(st.lists(st.booleans(), min_size=len(messages), max_size=len(messages)), st.integers(0, 80))
    def check(came, late):
        received = [message for k, message in enumerate(messages) if came[k] and k >= late]
        found, stream, notes = followed([*received, messages[-1]])
        assert found == numbers(messages)
        assert stream.missed == {} and notes == []
        assert stream.recovered >= len(numbers(messages)) - len(numbers(received))

    check()


def test_a_run_that_nobody_records_is_told_to_be_incomplete():
    messages = sent(60, None)

    @given(st.lists(st.booleans(), min_size=len(messages), max_size=len(messages)))
    def check(came):
        received = [message for message, here in zip(messages, came, strict=True) if here]
        found, stream, notes = followed([*received, messages[-1]])
        assert found == numbers(received)
        assert sum(stream.missed.values()) == len(numbers(messages)) - len(found)
        assert all("nothing is recorded from which they could be read" in note.text for note in notes)

    check()


def test_what_the_recorder_lost_is_taken_from_the_stream_and_told_where_it_has_neither(path):
    messages = sent(30, str(path))
    record(path, [m for m in messages if not (m[0] == FRAMES and 10 <= m[1]["frame0"] < 20)])
    found, stream, notes = followed([m for m in messages if m[0] != FRAMES or m[1]["frame0"] >= 15])
    missing = [(FRAMES, RUN, k) for k in range(10, 15)]
    assert sorted(found) == sorted(set(numbers(messages)) - set(missing))
    assert stream.missed == {FRAMES: 5}
    assert {note.kind for note in notes} == {"missed"}
    assert f"limb/frames: 4 messages from number 10 on did not come, and the recording {path}" in notes[0].text


def test_a_recording_that_cannot_be_read_here_is_named(path):
    _, stream, (note,) = followed(sent(30, str(path))[5:25])
    assert f"the recording {path} cannot be read here" in note.text and stream.missed[FRAMES] > 0


def test_another_daemons_recording_is_not_taken_for_this_ones(path):
    record(path, sent(60, str(path), run="another"))
    messages = sent(30, str(path))
    found, stream, _ = followed(messages[9:])
    assert found == numbers(messages[9:]) and stream.missed[FRAMES] == 7


def test_a_daemon_that_was_started_anew(path, tmp_path):
    second = tmp_path / "arm-22222222.mcap"
    before, after = sent(20, str(path)), sent(20, str(second), run="22222222-3333")
    record(path, before)
    record(second, after)
    found, stream, notes = followed([*before[8:], *after[11:]])
    assert found == [*numbers(before), *numbers(after)]
    assert stream.restarts == 1 and notes == []


def test_a_daemon_that_begins_anew_with_another_arm_is_refused():
    before, after = ((FRAMES, {"run": run, "arm": arm}) for run, arm in (("a", "left"), ("b", "right")))
    stream = CompleteStream(Inbox([before, after]), pytest.fail)
    assert stream.receive(0) == before
    with pytest.raises(ConfigError, match="with arm 'right', expected 'left' as before"):
        stream.receive(0)


@pytest.mark.parametrize(("expected", "kinds"), [("right", ["other_arm"]), ("left", []), (None, [])])
def test_a_stream_of_another_arm_is_noted_once(expected, kinds):
    notes = []
    messages = [(FRAMES, {"run": RUN, "arm": "left", "seq": seq}) for seq in range(3)]
    stream = CompleteStream(Inbox(messages), notes.append, Clock(), expected)
    assert [stream.receive(0) for _ in messages] == messages
    assert [note.kind for note in notes] == kinds


def test_a_stream_that_never_says_whether_it_is_recorded(path):
    silent = [m for m in sent(30, str(path)) if m[0] != HEALTH]
    found, stream, _ = followed(silent[8:])
    assert found == numbers(silent[8:]) and sum(stream.missed.values()) == 8


def test_the_recording_is_waited_for_as_long_as_it_grows(path):
    """The daemon's writer is behind: what is asked for is flushed only later."""
    messages = sent(30, str(path))
    writer = RecordingWriter(path, "", "")
    late = messages[20:]
    stream = CompleteStream(Inbox(late), lambda note: pytest.fail(note.text), lambda: 0.0)
    found = []
    for topic, fields in messages:
        writer.write(topic, encode(topic, fields)[1], 0)
        writer._sync()
        for _ in range(40):
            message = stream.receive(0)
            if message is not None and message[0] != HEALTH:
                found.append((message[0], RUN, message[1]["seq"]))
    assert found == numbers(messages) and not stream.waits
    writer.close()
    stream.close()


def test_messages_without_numbers_are_handed_on():
    message = (FRAMES, {"run": RUN})
    stream = CompleteStream(Inbox([message, ("other", {}), message]), pytest.fail)
    assert [stream.receive(0)[0] for _ in range(3)] == [FRAMES, "other", FRAMES]
