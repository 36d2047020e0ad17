"""After a gap within a motion the joints turn the way they do, which no single instant shows."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.bench import Bench
from tracking.kalman import multiple_model_filter as module
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.kalman.multiple_model_filter import MultipleModelFilter, _stretches
from tracking.model.decimation import Decimator
from tracking.model.expected_readings import observe, room_of
from tracking.model.noise import noise_of
from tracking.model.observation import observation_of
from tracking.model.zero_velocity import window_frames

RATE_HZ, FACTOR = 4000.0, 4


def through_a_gap(recording, begin_s, lost_s, until_s):
    """Return time [s] and frames of an arm of which a while is not seen."""
    begin, end, until = (round(s * RATE_HZ) for s in (begin_s, begin_s + lost_s, until_s))
    tracker = KalmanTracker(recording.arm, RATE_HZ, recording.q[0])
    frames = tracker.push(0, recording.readings[:begin])[0] + tracker.gap(end - begin)[0]
    for first in range(end, until, 40):
        block = recording.readings[first : min(first + 40, until)]
        frames += tracker.push(round(first * recording.dt_ns), block)[0]
    return frames


@pytest.mark.parametrize("name", ["dd_arm", "vertical_arm", "spatial"])
@pytest.mark.parametrize(("begin_s", "lost_s"), [(0.8, 0.3), (0.7, 0.5), (0.9, 1.2)])
def test_speeds_are_right_half_a_second_after_a_gap(name, begin_s, lost_s, request, recorded, gather):
    arm = request.getfixturevalue(name)
    wrong = 0
    for seed in (11, 12, 13):
        recording = recorded(arm, Bench(RATE_HZ, learning=1, evaluating=0), seed, 1.0)
        after_s = begin_s + lost_s
        tracked = gather(recording, through_a_gap(recording, begin_s, lost_s, after_s + 0.7), [])
        late = tracked.t_ns > 1e9 * (after_s + 0.5)
        wrong += np.abs(tracked.dq - tracked.truth("dq"))[late].max() > 0.15
    assert wrong <= 1  # an arm that turns slower than a tenth of a radian a second may be held to turn either way


def test_an_instant_does_not_show_which_way_an_arm_turns(dd_arm):
    """The level arm reads the same with every speed turned round, and with those of either link."""
    of, size = observation_of(replace(dd_arm, gravity_m_s2=(0.0, 0.0, 0.0)))
    readings = []
    for first, second in ((1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)):
        x = np.zeros(size)
        x[[0, 2, 3, 5]] = 0.3, 1.0, -0.4, 2.0
        x[1], x[4] = 0.7 * first, 1.9 * second - 0.7 * first  # links turn by 0.7 and 1.9 rad/s, either way
        reading, slope = np.empty(12), np.zeros((12, size))
        observe(of, room_of(2), x, reading, slope)
        readings.append(reading)
    np.testing.assert_allclose(readings, np.tile(readings[0], (4, 1)), rtol=0, atol=1e-12)


@pytest.fixture(scope="module")
def seen(level_bench):
    """Return an arm's frames with two gaps, the second right after the first was got over."""
    made = Decimator(FACTOR, 12).push(level_bench.readings[:12_000])
    made[900:1300] = np.nan
    made[1325:1700] = np.nan
    return level_bench.arm, made, noise_of(level_bench.readings[:1000], RATE_HZ)


@pytest.mark.parametrize("size", [1, 7, 10, 640])
def test_it_is_the_same_however_readings_come(seen, size):
    arm, readings, noise = seen
    cell, n_cell = window_frames(FACTOR / RATE_HZ)
    courses = []
    for piece in (len(readings), size):
        one = MultipleModelFilter(
            arm, np.zeros(2), True, readings[: cell * n_cell], noise, FACTOR, FACTOR / RATE_HZ
        )
        courses.append([one.follow(readings[k : k + piece]) for k in range(0, len(readings), piece)])
    for whole, *pieces in zip(*courses[0], *courses[1], strict=True):
        np.testing.assert_array_equal(whole, np.concatenate(pieces))


def test_readings_without_any_sense_are_survived(seen):
    arm, readings, noise = seen
    cell, n_cell = window_frames(FACTOR / RATE_HZ)
    one = MultipleModelFilter(arm, np.zeros(2), True, readings[: cell * n_cell], noise, FACTOR, FACTOR / RATE_HZ)
    one.follow(readings[:1300])
    nonsense = np.random.default_rng(0).normal(0.0, 50.0, (100, 12))
    nonsense[:40, 5] = np.nan
    assert np.isfinite(one.follow(nonsense).states).all()
    assert np.isfinite(one.follow(readings[1300:1320]).states).all()


def test_after_an_hour_the_angles_are_about_where_they_were(level_bench):
    """However fast the arm went: a level arm's angles are shown by nothing."""
    begin = 4000
    tracker = KalmanTracker(level_bench.arm, RATE_HZ, level_bench.q[0])
    tracker.push(0, level_bench.readings[:begin])
    hour = round(3600 * RATE_HZ)
    tracker.gap(hour)
    after, _ = tracker.push(round((begin + hour) * level_bench.dt_ns), level_bench.readings[6000:8000])
    assert np.abs(level_bench.dq[begin]).max() > 0.3
    assert max(np.abs(f.q - level_bench.q[begin]).max() for f in after) < 2.0


@pytest.mark.parametrize(
    ("flags", "parts"), [("00110", "00 11 0"), ("1", "1"), ("000", "000"), ("0101", "0 1 0 1")]
)
def test_frames_are_parted_where_some_are_lost_and_some_are_not(flags: str, parts: str) -> None:
    found = _stretches(np.array([flag == "1" for flag in flags]))
    assert " ".join(flags[part] for part in found) == parts


@pytest.mark.parametrize(
    ("apart", "alike"), [(0.0, True), (0.019, True), (-0.019, True), (0.021, False), (-2.0, False)]
)
def test_ways_are_the_same_that_turn_at_the_same_speeds(seen, apart: float, alike: bool) -> None:
    arm, readings, noise = seen
    cell, n_cell = window_frames(FACTOR / RATE_HZ)
    one = MultipleModelFilter(arm, np.zeros(2), True, readings[: cell * n_cell], noise, FACTOR, FACTOR / RATE_HZ)
    x = np.arange(1.0, 19.0)
    other = x + 5.0  # angles, accelerations and offsets have no say
    other[[1, 4]] = x[1], x[4] + apart
    assert one._alike(x, other) is alike
    assert one._alike(other, x) is alike


@pytest.fixture
def one(seen) -> MultipleModelFilter:
    arm, readings, noise = seen
    return MultipleModelFilter(arm, np.zeros(2), True, readings[:250], noise, FACTOR, FACTOR / RATE_HZ)


def test_a_search_begins_with_every_joint_turning_either_way(one) -> None:
    """Each a bit more than twice as fast as the one before it; nothing else is changed."""
    state = np.arange(18.0) + 100.0
    begun = list(one._beginnings(state))
    assert [tuple(x[[1, 4]]) for x in begun] == [(0.5, 1.1), (0.5, -1.1), (-0.5, 1.1), (-0.5, -1.1)]
    for x in begun:
        np.testing.assert_array_equal(np.delete(x, [1, 4]), np.delete(state, [1, 4]))
    one._n = 8
    begun = list(one._beginnings(np.zeros(40)))
    assert len(begun) == 64 and not np.any([x[18:] for x in begun])  # of six joints, and no more


@pytest.mark.parametrize(
    ("followed", "span"),
    [(0, 10), (7, 3), (20, 10), (29, 1), (30, 2), (31, 1), (32, 8), (39, 1), (40, 10), (3005, 5)],
)
def test_it_is_asked_which_way_is_best_every_ten_frames_and_after_the_first_moment(one, followed, span) -> None:
    one._followed = followed
    assert one._to_decision() == span


def way(misfit: float, speed: float) -> SimpleNamespace:
    x = np.zeros(18)
    x[4] = speed
    return SimpleNamespace(misfit=misfit, x=x)


def test_hypotheses_that_are_much_worse_or_alike_are_dropped(one) -> None:
    best, near, same, far = way(5.0, 0.1), way(44.9, -0.5), way(6.0, 0.11), way(45.1, 0.9)
    one._filter, one._rivals = best, [best, same, near, far]
    assert one._still_possible() == [best, near]
    one._rivals = [best, same, far]
    assert one._still_possible() == []  # decided


def test_all_remaining_hypotheses_take_another_rate_and_noise(one) -> None:
    said = []
    filters = [
        SimpleNamespace(
            retime=lambda dt, k=k: said.append((k, dt)),
            learn=lambda noise, k=k: said.append((k, noise)),
        )
        for k in range(3)
    ]
    one._rivals, one._lost, one._filter = filters[:2], filters[2], filters[0]
    one.retime(0.5)
    one.learn("noise")
    assert said == [(0, 0.5), (1, 0.5), (2, 0.5), (0, "noise"), (1, "noise"), (2, "noise")]
    said.clear()
    one._rivals = []
    one.retime(0.5)
    one.learn("noise")
    assert said == [(0, 0.5), (0, "noise")]


class Rival(SimpleNamespace):
    """Stands for a filter that has some misfit; filters are compared by identity."""

    __hash__ = object.__hash__


def test_hypotheses_are_followed_for_three_seconds(one) -> None:
    """Asked for the last time, it goes on with the best and forgets the others."""
    course = np.zeros(1)
    rivals = [Rival(misfit=misfit, x=way(misfit, misfit).x, follow=lambda _: course) for misfit in (3.0, 1.0)]
    for followed, left in ((2980, 2), (2989, 2), (2990, 0)):
        one._rivals, one._filter, one._followed = rivals[:], rivals[0], followed
        one._compete(np.zeros((one._to_decision(), 12)))
        assert len(one._rivals) == left and one._filter is rivals[1]


def test_the_eight_likeliest_hypotheses_are_followed(one, monkeypatch) -> None:
    misfits = iter([7.0, 3.0, np.inf, 1.0, *np.arange(20.0, 28.0)])
    states = iter(np.arange(1.0, 13.0)[:, None] * np.ones(18))
    supposed = []
    monkeypatch.setattr(module, "_explained", lambda *_: (next(states), next(misfits)))
    monkeypatch.setattr(one, "_beginnings", lambda _: range(12))
    monkeypatch.setattr(module.RestartedFilter, "regain", lambda *_: None)
    monkeypatch.setattr(module.RestartedFilter, "suppose", lambda _, readings, at: supposed.append(at[0]))
    assert len(one._ways(np.zeros((1, 12)))) == 8
    assert supposed == [4.0, 2.0, 1.0, 5.0, 6.0, 7.0, 8.0, 9.0]
