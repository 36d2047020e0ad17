"""How passes come to their end, where each is a line through the answer; and what a recording begins with."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from limbcal.errors import DataError
from tracking.smoother import smoother as module
from tracking.smoother.smoother import Smoother, state_before

RATE_HZ, STD = 250.0, 2.0


@dataclass(frozen=True)
class Found:
    """What stands for a smoothed motion."""

    states: np.ndarray
    begin: float
    course: None
    found: None
    converged: bool


@pytest.fixture
def passes(level_bench, decimated, monkeypatch):
    """Return what smooths where every pass leaves a share of what it begins off by, in units of claims."""
    whole = decimated(level_bench, RATE_HZ)
    readings = module.Readings(whole.values[:200], whole.dt_s, whole.t0_s, whole.noise, whole.factor)
    smoother, counted, turns, reported = Smoother(level_bench.arm, np.zeros(2), True), [], {}, []

    def smoothed(share, off, fine=False, explaining=False, gain=2.0):
        def away(by):
            at = np.zeros((50, smoother.size))
            at[7, 4] = STD * by
            return at

        def unwound(*_, **__):
            by = turns.pop(len(counted) + 1, None)
            return None if by is None else away(by)

        def once(of, room, course, along, x, P, found, with_variance):
            found.states[:] = share * along
            reported.append(with_variance)
            P[:] = STD**2 * np.eye(len(P))
            return -gain * len(reported)

        monkeypatch.setattr(module, "every", lambda states, stride: away(off))
        monkeypatch.setattr(module, "smooth_once", once)
        monkeypatch.setattr(module, "calm", lambda at, *_: at)
        monkeypatch.setattr(module, "unwound", unwound)
        found = smoother.smooth(readings, fine, progress=counted.append, explaining=explaining)
        assert counted == list(range(1, found.passes + 1))
        counted.clear()
        return found

    smoothed.turns, smoothed.reported = turns, reported
    return smoothed


@pytest.mark.parametrize(
    ("share", "off", "expected"),
    [
        *((0.5, 0.0398, 1), (0.5, 0.0402, 2), (0.5, -1.0, 6)),  # by halves: 0.5, 0.25, ... until less than 0.02
        *((-1.0, 1.0, 4), (-3.0, 0.1, 5)),  # swings: half the way from the third pass on, then a quarter
        *((0.69, 0.13, 3), (0.71, 0.13, 3), (0.69, 0.5, 7)),
    ],
)
def test_passes_end_when_nothing_moves_by_a_fiftieth_of_its_claim(passes, share, off, expected):
    found = passes(share, off)
    assert found.converged and found.passes == expected
    assert passes.reported == [False] * expected + [True]  # variances are wanted of the last one only


@pytest.mark.parametrize("share", [0.8, -7.0])
def test_thirty_passes_are_enough(passes, share):
    """The steps are no shorter than a quarter, which takes from the one too little and throws the other over."""
    found = passes(share, 1.0)
    assert not found.converged and found.passes == 30


@pytest.mark.parametrize(("share", "gain", "expected"), [(-7.0, 0.9, 7), (-7.0, 1.1, 30), (0.5, 0.0, 6)])
def test_passes_that_swing_end_where_none_is_likelier(passes, share, gain, expected):
    """From the fourth pass on they are halved, and four are within half a nat, of which a pass returns twice."""
    found = passes(share, 1.0, gain=gain)
    assert found.passes == expected and found.converged == (expected < 30)


@pytest.mark.parametrize(
    ("explaining", "against", "expected"), [(True, True, 6), (True, False, 30), (False, True, 30)]
)
def test_a_motion_that_explains_nothing_is_given_up_after_four_passes_in_vain(
    passes, monkeypatch, explaining, against, expected
):
    """The third pass is the first that can be seen to get no nearer."""
    monkeypatch.setattr(module, "contradicted", lambda *_: against)
    found = passes(-7.0, 1.0, explaining=explaining)
    assert not found.converged and found.passes == expected


@pytest.mark.parametrize(("explaining", "share"), [(True, 0.51), (True, 0.49), (False, 0.51)])
def test_an_alternative_that_most_instants_contradict_is_given_up_at_once(passes, monkeypatch, explaining, share):
    """No estimate tells outliers from readings where outliers are the majority."""
    monkeypatch.setattr(module, "_doubted", lambda _: share)
    found = passes(0.5, -1.0, explaining=explaining)
    given_up = explaining and share > 0.5
    assert (found.passes == 0) == given_up and found.converged != given_up


@pytest.mark.parametrize(("explaining", "against"), [(True, True), (True, False), (False, True)])
def test_what_does_not_explain_the_first_seconds_is_not_asked_for_more(
    level_bench, decimated, monkeypatch, explaining, against
):
    """Of a recording that begins in motion, of which the first ten seconds are smoothed first."""
    whole = decimated(level_bench, RATE_HZ)
    begin = int(np.argmax(np.ptp(whole.values[:300], axis=1))) + 60
    values = whole.values[begin:]
    moving = module.Readings(np.vstack([values, values[::-1]]), whole.dt_s, whole.t0_s, whole.noise, whole.factor)
    smoother, asked = Smoother(level_bench.arm, np.zeros(2), True), []

    def smoothed(readings, x0, P0, begin, *rest):
        asked.append(len(readings.values))
        return Found(np.full((1, 3), 7.0), begin[0], None, None, True)

    monkeypatch.setattr(smoother, "_smooth", smoothed)
    monkeypatch.setattr(module, "contradicted", lambda *_: against)
    found = smoother.smooth(moving, explaining=explaining)
    assert moving.begins_in_motion and asked[0] == 10 * RATE_HZ < len(moving.values)
    if explaining and against:
        assert len(asked) == 1 and not found.converged
    else:
        assert asked[1:] == [len(moving.values)] and found.begin == 7.0


def test_steps_are_whole_again_where_a_motion_was_unwound(passes):
    passes.turns[4] = 1.0
    found = passes(-1.0, 1.0)
    assert (found.passes, found.converged) == (7, True)  # swings twice anew, then half the way


def test_every_frame_is_given_by_one_more_pass(passes):
    found = passes(0.5, 1.0, fine=True)
    assert found.passes == 6 and passes.reported == [False] * 6 + [True]
    assert found.states.shape[0] == 200


def test_states_without_a_number_are_no_motion(passes):
    with pytest.raises(DataError, match="no motion of this arm"):
        passes(np.nan, 1.0)


@pytest.fixture
def begun(dd_arm, monkeypatch):
    """Return a smoother that begins with state 0, 1, 2, ... and the identity."""
    smoother = Smoother(dd_arm, np.zeros(2), True)
    size = smoother.size
    monkeypatch.setattr(smoother, "begin", lambda _: (np.arange(float(size)), np.eye(size)))
    return smoother


def test_constants_of_an_earlier_recording_are_held(begun):
    size = begun.size
    known = SimpleNamespace(final=-np.arange(float(size)), covariance=np.full((size, size), 7.0))
    x, P = begun._before(None, known, None, None)
    np.testing.assert_array_equal(x, [*np.arange(6.0), *-np.arange(6.0, size)])
    np.testing.assert_array_equal(P[6:, 6:], 7.0)
    np.testing.assert_array_equal(P[:6], np.eye(size)[:6])
    np.testing.assert_array_equal(P[:, :6], np.eye(size)[:, :6])


def test_a_start_is_taken_as_it_is_and_not_changed(begun):
    start = np.full(begun.size, 3.0), 4.0 * np.eye(begun.size)
    previous = SimpleNamespace(continued=lambda x, P: (x.fill(5.0), P.fill(6.0)))
    x, P = begun._before(None, None, start, None)
    np.testing.assert_array_equal(x, start[0])
    np.testing.assert_array_equal(P, start[1])
    x, P = begun._before(None, None, start, previous)
    assert set(x) == {5.0} and set(P.ravel()) == {6.0} and set(start[0]) == {3.0}
    x, P = begun._before(None, None, None, previous)
    assert set(x) == {5.0} and set(P.ravel()) == {6.0}


def test_a_state_before_a_frame_is_that_of_the_readings_up_to_it(level_bench, decimated):
    """It is smoothed no further: that after the frames before it, carried on by one."""
    whole = decimated(level_bench, RATE_HZ)
    readings = module.Readings(whole.values[:300], whole.dt_s, whole.t0_s, whole.noise, whole.factor)
    smoother = Smoother(level_bench.arm, np.zeros(2), True)
    found = smoother.smooth(readings)
    x0, P0 = smoother.begin(readings)
    x, P = state_before(200, smoother.observation, found.course, found.along, x0, P0)
    again = smoother.smooth(readings, until=200)
    np.testing.assert_allclose(again.final, x, rtol=1e-9, atol=1e-12)
    dt = readings.dt_s
    F = np.eye(smoother.size)
    for j in range(2):
        F[3 * j, 3 * j + 1] = F[3 * j + 1, 3 * j + 2] = dt
        F[3 * j, 3 * j + 2] = dt**2 / 2.0
    short = found.course._replace(
        **{name: getattr(found.course, name)[:200] for name in ("readings", "present", "jolt", "doubt", "rest")}
    )
    last_x, last_P = x0.copy(), P0.copy()
    room = module.room_of(2)
    seen = module.pass_of(smoother.observation, short, smoother.size)
    module.smooth_once(smoother.observation, room, short, found.along[:200], last_x, last_P, seen, False)
    np.testing.assert_allclose(x, F @ last_x, rtol=1e-9, atol=1e-12)
    carried = F @ last_P @ F.T
    assert (np.diag(P)[:6] > np.diag(carried)[:6]).all()
    np.testing.assert_allclose(np.delete(P - carried, range(6), axis=0)[:, :6], 0.0, atol=1e-12)
