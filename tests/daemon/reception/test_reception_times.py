"""When samples were taken, and why others are missing, by a device's clock that the test sets."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from daemon.acquisition.ring import Chunk, Mark
from daemon.clock.device_clock import ClockState
from daemon.reception.reception import Reception
from protocol.serial_frame import InfoFrame, encode_info, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info

#: Frames of 32 samples at 8 kHz: 4 ms and 4000 ticks of a microsecond each.
INFO = device_info(8000.0)
STEP, STEP_NS = 4000, 4_000_000
NOW_NS = 10**12


@dataclass
class Clock:
    """A microsecond a tick, from the first sample on."""

    arguments: tuple[Any, ...]
    early: float = 0.0
    state: ClockState = ClockState(None, None, None, 0.75)
    notes: list[tuple[int, int]] = field(default_factory=list)

    def utc_ns(self, ticks: int) -> int:
        return 10**18 + 1000 * ticks

    def monotonic_ns(self, ticks: int) -> int:
        return int(self.arguments[2]) + 1000 * (ticks - int(self.arguments[1]))

    def early_s(self, _ticks: int, _arrival_ns: int) -> float:
        return self.early

    def note(self, ticks: int, arrival_ns: int) -> None:
        self.notes.append((ticks, arrival_ns))


class Taker:
    """A reception, and the clocks that it has begun."""

    def __init__(self, early: float = 0.0) -> None:
        self.clocks: list[Clock] = []
        self.early = early
        self.reception = Reception(FrameParser(), InfoFrame(0, 0, INFO), new_clock=self._new)
        self.now_ns = NOW_NS

    def _new(self, *arguments: Any) -> Clock:
        self.clocks.append(Clock(arguments, self.early))
        return self.clocks[-1]

    def take(self, *frames: bytes, after_ns: int = STEP_NS, mark: Mark = Mark.DATA) -> None:
        self.now_ns += after_ns
        self.reception.take([Chunk(self.now_ns, b"".join(frames), mark)], self.now_ns)

    def gaps(self) -> list[tuple[int, int, int, str, bool]]:
        return [(one.sample0, one.samples, one.t_ns, one.why, one.exact) for one in self.reception.new_gaps()]


def sample(number: int, ticks: int | None = None, n: int = 32) -> bytes:
    """Return a frame; the first one's number is 1, and its clock 0."""
    return encode_samples(
        np.zeros((n, 12), dtype=np.int16), number, STEP * (number - 1) if ticks is None else ticks
    )


def samples(*numbers: int) -> list[bytes]:
    return [sample(number) for number in numbers]


def began(taker: Taker, frames: int = 3) -> Taker:
    for number in range(1, frames + 1):
        taker.take(sample(number))
    return taker


@pytest.mark.parametrize(
    ("frames", "ended"),
    [([sample(1)], 32), (samples(1, 2), 64), (samples(*range(1, 9)), 256), ([sample(1), sample(2, n=8)], 40)],
)
def test_the_last_sample_that_came_first_was_taken_when_it_came(frames: list[bytes], ended: int) -> None:
    taker = Taker()
    taker.take(*frames)
    (clock,) = taker.clocks
    first_ns = taker.now_ns - ended * 125_000
    assert clock.arguments == (1e6, 0, first_ns, taker.reception.host.offset_ns, 1.0)


def test_a_restarted_device_gets_a_new_clock_at_its_old_rate() -> None:
    """Its first two frames come 100 ms after the last of before were over: 92 ms are missing."""
    taker = began(Taker())
    ended_ns = taker.clocks[0].monotonic_ns(3 * STEP)
    taker.now_ns = ended_ns
    taker.take(sample(1, 7), sample(2, 7 + STEP), after_ns=100_000_000)
    first_ns = ended_ns + 92_000_000
    assert taker.clocks[1].arguments == (1e6, 7, first_ns, taker.reception.host.offset_ns, 0.75)
    assert taker.gaps() == [(96, 736, 10**18 + 7000 - 92_000_000, "the device was restarted", False)]


def test_a_restart_within_no_time_loses_nothing_and_takes_none_back() -> None:
    taker = began(Taker())
    ended_ns = taker.clocks[0].monotonic_ns(3 * STEP)
    taker.take(sample(1, 7), sample(2, 7 + STEP), after_ns=1)
    assert taker.clocks[1].arguments[2] == ended_ns
    assert taker.gaps() == [(96, 0, 10**18 + 7000, "the device was restarted", False)]


def test_a_restart_among_frames_that_wait_counts_from_the_last_of_them() -> None:
    """A step that doubts the rate is followed by the restart; four of its frames come together."""
    taker = Taker()
    taker.take(sample(1))
    taker.take(sample(2, 2 * STEP))  # twice what INFO says
    taker.take(*(sample(number, 100 + STEP * (number - 1)) for number in (1, 2, 3, 4)))
    taker.reception.finish()
    assert len(taker.clocks) == 2
    ended_ns = taker.clocks[0].monotonic_ns(3 * STEP)
    assert taker.clocks[1].arguments[2] == max(ended_ns, taker.now_ns - 4 * STEP_NS)


def test_every_arrival_is_held_against_the_end_of_what_came() -> None:
    taker = Taker()
    taker.take(*samples(1, 2))
    taker.take(*samples(3))
    taker.take(encode_info(INFO, 4, 3 * STEP))  # has no samples
    assert taker.clocks[0].notes == [(2 * STEP, NOW_NS + STEP_NS), (3 * STEP, NOW_NS + 2 * STEP_NS)]
    taker.take(sample(5, 5 * STEP))  # a step that INFO's rate does not explain waits
    assert len(taker.clocks[0].notes) == 2


def test_nothing_of_an_unknown_device_is_held_against_the_clock() -> None:
    taker = began(Taker())
    taker.take(b"pulled", mark=Mark.LOST)
    taker.take(b"", mark=Mark.OPENED)
    taker.take(*samples(4, 5))
    assert len(taker.clocks[0].notes) == 3
    came_ns = taker.now_ns
    taker.take(encode_info(INFO, 6, 5 * STEP))
    assert taker.clocks[0].notes[3:] == [(5 * STEP, came_ns)]  # when they came, not when they were known


@pytest.mark.parametrize(
    ("after_ns", "why"), [(300_000_000, "frames missing"), (300_000_001, "the device was silent")]
)
def test_more_than_300_ms_without_a_byte_are_silence(after_ns: int, why: str) -> None:
    taker = began(Taker())
    taker.take(sample(5), after_ns=after_ns)
    taker.take(*samples(6, 7, 8, 9))
    assert taker.gaps() == [(96, 32, 10**18 + 12_000_000, why, True)]


def test_before_the_first_byte_nothing_was_silent() -> None:
    taker = Taker()
    taker.take(sample(5))
    taker.reception.finish()
    assert taker.gaps() == [(0, 128, 10**18, "frames missing", True)]


def test_a_daemon_that_fell_behind_blames_no_silence() -> None:
    taker = began(Taker())
    taker.reception.dropped()
    taker.take(sample(5), after_ns=10**9)
    taker.take(*samples(6, 7, 8, 9))
    assert [gap[3] for gap in taker.gaps()] == ["the daemon fell behind"]


def test_what_was_found_out_explains_one_gap() -> None:
    taker = began(Taker(), 8)
    taker.reception.dropped()
    taker.take(*samples(10, 11, 12, 13, 14))
    taker.take(*samples(16, 17, 18, 19, 20))
    taker.reception.finish()
    assert [gap[3] for gap in taker.gaps()] == ["the daemon fell behind", "frames missing"]


@pytest.mark.parametrize("unplugged", [True, False])
def test_a_lost_info_leaves_a_gap_exact_only_where_the_cable_was_pulled(unplugged: bool) -> None:
    """Two numbers are missing, and by both clocks the samples of one frame: the other number was an INFO's."""
    taker = began(Taker())
    if unplugged:
        taker.take(b"pulled", mark=Mark.LOST)
        taker.take(b"", mark=Mark.OPENED)
        taker.take(encode_info(INFO, 6, 3 * STEP))
    taker.take(*(sample(number, STEP * (number - 3)) for number in (7, 8, 9, 10)))
    taker.reception.finish()
    gaps = taker.gaps()
    assert unplugged == (gaps == [(96, 32, 10**18 + 12_000_000, "unplugged", True)])
    assert {exact for *_, exact in gaps} == {unplugged}


@pytest.mark.parametrize("asked", [1, 2])
def test_an_answer_that_comes_late_and_is_lost_among_samples_has_none(asked: int) -> None:
    """Asked twice, a device answers twice; its second INFO, number 9, is lost with the frames 10 and 11."""
    taker = began(Taker())
    taker.take(b"pulled", mark=Mark.LOST)
    taker.take(b"", mark=Mark.OPENED)
    for _ in range(asked):
        taker.take(b"", mark=Mark.ASKED)
    taker.take(encode_info(INFO, 5, 4 * STEP))
    taker.take(*(sample(number, STEP * (number - 2)) for number in (6, 7, 8)))
    taker.take(*(sample(number, STEP * (number - 3)) for number in (12, 13, 14)))
    taker.reception.finish()
    first, second = (gap for gap in taker.gaps() if gap[1])
    assert first[:2] == (96, 32)
    assert (second[0], second[1], second[4]) == ((224, 64, True) if asked == 2 else (224, 96, False))
    assert taker.reception.requests.unanswered == 0  # the one that was lost answers no other number


def test_a_clock_that_jumps_is_a_gap_without_samples() -> None:
    taker = began(Taker(early=1.0), 9)  # by the host's clock there was no time for it
    taker.take(*(sample(number, STEP * (number - 1) + 2_500_000) for number in (10, 11, 12)))
    assert taker.gaps() == [(288, 0, 10**18 + 36_000_000, "the device's clock jumped by +2.5 s", False)]
    assert taker.reception.ledger.causes == {"the device's clock jumped": 1}


@pytest.mark.parametrize(("after_ns", "entered"), [(20_000_000, 9), (20_000_001, 10)])
def test_a_frame_whose_clock_is_in_doubt_waits_as_long(after_ns: int, entered: int) -> None:
    taker = began(Taker(), 9)
    taker.take(sample(10, 10**7))
    taker.reception.take([], taker.now_ns + after_ns)
    assert taker.reception.ledger.samples == 32 * entered


def test_frames_waiting_for_an_info_are_lost_with_the_port() -> None:
    taker = began(Taker())
    for _ in range(2):
        taker.take(b"pulled", mark=Mark.LOST)
        connected = [taker.reception.connected]
        taker.take(b"", mark=Mark.OPENED)
        connected.append(taker.reception.connected)
        assert connected == [False, True] and taker.reception.awaits_info
        taker.take(*samples(4, 5, 6))
    assert (taker.reception.identity.strangers, taker.reception.reconnects) == (3, 2)


def test_runs_of_another_width_are_strangers() -> None:
    taker = began(Taker())
    narrow = [encode_samples(np.zeros((32, 6), dtype=np.int16), k, STEP * (k - 1)) for k in range(4, 9)]
    taker.take(*narrow)
    assert (taker.reception.identity.strangers, taker.reception.ledger.samples) == (5, 96)


def test_chunks_are_taken_as_one_up_to_a_mark() -> None:
    taker = Taker()
    stamps = (NOW_NS, NOW_NS + 5, NOW_NS + 9)
    data = [Chunk(stamp, sample(number)) for stamp, number in zip(stamps, (1, 2, 3), strict=True)]
    taker.reception.take([*data[:2], Chunk(NOW_NS + 6, b"pulled", Mark.LOST), data[2]])
    assert taker.reception.ledger.samples == 96
    assert taker.clocks[0].notes == [(2 * STEP, NOW_NS + 5), (3 * STEP, NOW_NS + 9)]


def test_before_anything_came_there_is_a_device_and_no_rate() -> None:
    reception = Taker().reception
    assert reception.connected and not reception.awaits_info and not reception.knows_rate(2**62)
    assert (reception.reconnects, reception.identity.strangers, reception.identity.stranger) == (0, 0, None)
    assert reception.new_gaps() == [] and reception.take([], NOW_NS) == []


@pytest.mark.parametrize(("lost", "exact"), [(64, True), (32, True), (48, False), (96, False)])
def test_after_a_pulled_cable_infos_may_explain_the_numbers(lost: int, exact: bool) -> None:
    """Two numbers are missing, of 32 samples each unless they were those of INFO frames."""
    taker = began(Taker())
    taker.take(b"pulled", mark=Mark.LOST)
    taker.take(b"", mark=Mark.OPENED)
    taker.take(encode_info(INFO, 6, 3 * STEP))
    taker.take(*(sample(number, 3 * STEP + 125 * lost + STEP * (number - 7)) for number in (7, 8, 9, 10)))
    taker.reception.finish()
    assert taker.gaps() == [(96, lost, 10**18 + 12_000_000, "unplugged", exact)]


def test_the_largest_error_of_stamps_since_it_was_last_asked_is_stated() -> None:
    taker = Taker()
    assert taker.reception.take_error_ms() is None
    for k, error_ms in enumerate((None, 2.0, 60.0, 3.0)):
        if taker.clocks:
            taker.clocks[-1].state = ClockState(None, None, error_ms)
        taker.take(encode_samples(np.zeros((32, 12), dtype=np.int16), k + 1, STEP * k))
    assert taker.reception.take_error_ms() == 60.0
    assert taker.reception.take_error_ms() == 3.0  # as it still is
