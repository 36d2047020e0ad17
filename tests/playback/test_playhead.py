"""Which frame is due when, whatever is asked for in between, by a clock that the test moves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbcal.errors import ConfigError
from playback.playhead import Clocks, Due, Playhead

EPOCH_NS = 10**18


class Time:
    def __init__(self) -> None:
        self.now_s = 7.0
        self.clocks = Clocks(lambda: self.now_s, lambda: EPOCH_NS + round((self.now_s - 7.0) * 1e9))


def drain(head: Playhead) -> list[Due]:
    due = []
    while (frame := head.take_due()) is not None:
        due.append(frame)
    return due


def playing(rate_hz: float, duration_s: float) -> tuple[Playhead, Time]:
    time = Time()
    head = Playhead(rate_hz, time.clocks)
    head.load(duration_s)
    head.play()
    return head, time


wishes = st.lists(
    st.tuples(
        st.floats(0.0, 0.5),
        st.one_of(
            st.tuples(st.just("seek"), st.floats(0.0, 3.0)),
            st.tuples(st.just("speed"), st.floats(0.1, 10.0)),
            st.tuples(st.just("play"), st.just(0.0)),
        ),
    ),
    max_size=12,
)


@settings(deadline=None)
@given(rate_hz=st.floats(1.0, 1000.0), wishes=wishes)
def test_nothing_that_is_asked_for_moves_the_beat(
    rate_hz: float, wishes: list[tuple[float, tuple[str, float]]]
) -> None:
    head, time = playing(rate_hz, 3.0)
    head.loop = True
    frames: list[Due] = []
    for wait_s, (what, value) in wishes:
        time.now_s += wait_s
        frames += drain(head)
        {"seek": head.seek, "speed": head.set_speed, "play": lambda _: head.play()}[what](value)
    time.now_s += 0.5
    frames += drain(head)
    beats = (np.array([frame.t0_ns for frame in frames]) - EPOCH_NS) * 1e-9 * rate_hz
    np.testing.assert_allclose(beats, np.arange(len(frames)), atol=1e-5)
    assert len(frames) == pytest.approx((time.now_s - 7.0) * rate_hz + 1, abs=1.0 + 1e-5)
    assert all(0.0 <= frame.position_s <= 3.0 for frame in frames)


@settings(deadline=None)
@given(rate_hz=st.floats(10.0, 1000.0), speed=st.floats(0.1, 10.0), duration_s=st.floats(0.5, 5.0))
def test_places_are_a_speed_apart_and_end_at_the_end(rate_hz: float, speed: float, duration_s: float) -> None:
    head, time = playing(rate_hz, duration_s)
    head.set_speed(speed)
    expected = head.upcoming(5)
    time.now_s += 60.0
    places = [frame.position_s for frame in drain(head)]
    np.testing.assert_array_equal(places[:5], expected)
    np.testing.assert_allclose(np.diff(places), speed / rate_hz, atol=1e-5 / rate_hz)
    assert duration_s - places[-1] < speed / rate_hz
    assert not head.playing
    assert head.finished == 1


def test_a_pause_is_gone_on_from_and_the_end_is_followed_by_the_beginning() -> None:
    head, time = playing(100.0, 1.0)
    time.now_s += 0.305
    assert drain(head)[-1] == Due(30, 0.3, EPOCH_NS + 300_000_000)
    head.pause()
    time.now_s += 5.0
    assert drain(head) == []
    assert head.position_s == 0.3
    head.play()
    time.now_s += 0.005
    assert drain(head) == [Due(31, 0.3, EPOCH_NS + 5_305_000_000)]
    time.now_s += 1.0
    assert drain(head)[-1].position_s == pytest.approx(1.0)
    head.play()
    assert drain(head)[0][:2] == (0, 0.0)


def test_what_is_sought_or_stepped_to_is_shown_at_once_and_once() -> None:
    head, time = playing(50.0, 2.0)
    time.now_s += 0.05
    drain(head)
    head.step(3)
    assert not head.playing
    assert [frame.position_s for frame in drain(head)] == [pytest.approx(0.1)]
    head.step(-100)
    assert [frame.position_s for frame in drain(head)] == [0.0]
    head.seek(1.234)
    time.now_s += 1.0
    assert [frame.position_s for frame in drain(head)] == [1.234]
    assert head.deadline_s() is None
    head.play()
    assert head.take_due().position_s == 1.234


def test_a_place_sought_just_before_a_pause_is_shown() -> None:
    head, time = playing(50.0, 2.0)
    time.now_s += 0.05
    drain(head)
    head.seek(1.234)
    head.pause()
    assert [frame.position_s for frame in drain(head)] == [1.234]
    head.play()
    drain(head)
    head.pause()
    assert drain(head) == [] and head.deadline_s() is None


def test_the_end_can_be_sought_and_nothing_beyond_it() -> None:
    head, time = playing(10.0, 0.5)
    time.now_s += 10.0
    assert drain(head)[-1].position_s == 0.5 and not head.playing
    head.seek(0.5)
    assert [frame.position_s for frame in drain(head)] == [0.5]
    for beyond in (np.nextafter(0.5, 1.0), 0.5 + 1e-9, 1e9):
        with pytest.raises(ConfigError, match="expected 0 to 0.5"):
            head.seek(float(beyond))
        assert head.position_s == 0.5
    with pytest.raises(ConfigError, match="position_s is 0.50000001, expected 0 to 0.5"):
        head.seek(0.50000001)
    head.seek(0.3)  # back from the end: it is gone on from there, and not from the beginning
    drain(head)
    head.play()
    time.now_s += 10.0
    assert [frame.position_s for frame in drain(head)] == pytest.approx([0.3, 0.4, 0.5])


def test_a_loop_goes_round_without_a_pause() -> None:
    head, time = playing(10.0, 0.5)
    head.loop = True
    time.now_s += 1.75
    frames = drain(head)
    assert [round(10 * frame.position_s) for frame in frames] == [*range(6), *range(6), *range(6)]
    assert [frame.number for frame in frames] == [*range(6), *range(6), *range(6)]
    assert head.finished == 3


def test_what_is_out_of_range_changes_nothing() -> None:
    head, time = playing(10.0, 0.5)
    for wrong in (-0.1, 0.6, float("nan"), float("inf")):
        with pytest.raises(ConfigError, match="position_s is .*, expected 0 to 0.5"):
            head.seek(wrong)
    for wrong in (0.0, -1.0, 10.1, float("nan")):
        with pytest.raises(ConfigError, match="speed is .*, expected 0.1 to 10"):
            head.set_speed(wrong)
    time.now_s += 1.0
    assert len(drain(head)) == 6


def test_the_slowest_and_the_fastest_speed_are_allowed() -> None:
    head, _ = playing(10.0, 0.5)
    for speed in (0.1, 10.0):
        head.set_speed(speed)
        assert head.speed == speed
    for speed in (np.nextafter(0.1, 0.0), np.nextafter(10.0, 11.0)):
        with pytest.raises(ConfigError, match="speed is"):
            head.set_speed(float(speed))


def test_what_ended_between_two_frames_begins_anew() -> None:
    head, time = playing(10.0, 0.55)
    time.now_s += 1.0
    assert drain(head)[-1].position_s == pytest.approx(0.5)
    head.play()
    assert drain(head)[0][:2] == (0, 0.0)
    head.pause()
    head.seek(0.55)  # and so does what stands at its end
    head.play()
    assert drain(head)[0].position_s == 0.0


def test_what_stands_still_has_one_frame_coming() -> None:
    head, time = playing(10.0, 0.5)
    assert (Playhead(10.0, time.clocks).speed, head.loop, head.finished) == (1.0, False, 0)
    head.pause()
    head.seek(0.2)
    assert head.upcoming(5).tolist() == [0.2]
    assert head.deadline_s() == time.now_s
    head.step(100)
    assert head.position_s == 0.5
    head.step(-1)
    assert head.position_s == pytest.approx(0.4)


def test_frames_to_come_end_with_the_motion() -> None:
    head, _ = playing(10.0, 0.3)
    assert head.upcoming(3) == pytest.approx([0.0, 0.1, 0.2])
    assert head.upcoming(9) == pytest.approx([0.0, 0.1, 0.2, 0.3])
    assert head.deadline_s() == 7.0
