"""Drift, put in and taken out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.data.drift import DriftCorrection, dead_reckoned, without_drift

DT_S = 0.001
ALL = dead_reckoned("integrate")


def motion(seconds, goal=(1.0, -0.5)):
    """Return time and columns of a motion along the polynomial of fifth degree, and of a tenth of it at rest."""
    n = round(seconds / DT_S) + 1
    t = DT_S * np.arange(n)
    moving_s = 0.9 * t[-1]
    s = np.minimum(t[:, None] / moving_s, 1.0)
    goal = np.asarray(goal)
    q = goal * (10 * s**3 - 15 * s**4 + 6 * s**5)
    dq = goal * (30 * s**2 - 60 * s**3 + 30 * s**4) / moving_s
    ddq = goal * (60 * s - 180 * s**2 + 120 * s**3) / moving_s**2
    points = np.repeat(q[:, :1, None], 3, axis=2) * np.ones((1, 4, 3))
    return t, {"q": q, "dq": dq, "ddq": ddq, "points": points, "ref": q + 1.0}


def drifting(t, columns, q_error, point_error):
    """Add constant errors of acceleration, integrated: one a joint, one for every axis of every sensor."""
    s = (t - t[0])[:, None]
    return columns | {
        "q": columns["q"] + q_error * s**2 / 2,
        "dq": columns["dq"] + q_error * s,
        "ddq": columns["ddq"] + q_error,
        "points": columns["points"] + point_error * s[:, :, None] ** 2 / 2,
    }


errors = st.lists(st.floats(-0.2, 0.2), min_size=2, max_size=2).map(np.array)


@settings(max_examples=50, deadline=None)
@given(seconds=st.floats(0.5, 8.0), q_error=errors, seed=st.integers(0, 100))
def test_a_constant_error_of_acceleration_is_taken_out(seconds, q_error, seed):
    t, true = motion(seconds)
    point_error = 0.1 * np.random.default_rng(seed).normal(size=(4, 3))
    corrected = DriftCorrection().moving(t, drifting(t, true, q_error, point_error), ALL)
    left = 0.025 / seconds  # the velocity that is left is a mean over the last 20 ms
    for name, size in (("q", seconds**2 / 2), ("dq", seconds), ("ddq", 1.0)):
        assert np.abs(corrected[name] - true[name]).max() <= left * np.abs(q_error).max() * size + 1e-9
    assert np.abs(corrected["points"] - true["points"]).max() <= left * np.abs(point_error).max() * seconds**2 / 2
    assert np.array_equal(corrected["ref"], true["ref"])


def test_the_next_motion_begins_where_this_one_really_ended():
    t, true = motion(4.0)
    correction = DriftCorrection()
    first = correction.moving(t, drifting(t, true, np.array([0.05, -0.02]), 0.01), ALL)
    stood = {name: values[-1:] for name, values in drifting(t, true, np.array([0.05, -0.02]), 0.01).items()}
    assert np.allclose(correction.resting(stood)["q"], first["q"][-1], atol=1e-12)
    assert np.allclose(correction.resting(stood)["points"], first["points"][-1], atol=1e-12)
    assert np.array_equal(correction.resting(stood)["dq"], stood["dq"])  # a rest's velocity is what it is


def test_columns_that_are_not_there_are_not_missed():
    t, true = motion(2.0)
    drift = drifting(t, true, np.array([0.1, 0.1]), 0.0)
    whole = DriftCorrection().moving(t, drift, ALL)
    for names in (("q",), ("q", "dq"), ("points",), ("ref",)):
        part = DriftCorrection().moving(t, {name: drift[name] for name in names}, ALL)
        assert set(part) == set(names)
        assert all(np.array_equal(part[name], whole[name]) for name in names)


@pytest.mark.parametrize("n", [0, 1, 2])
def test_a_motion_of_hardly_any_samples_is_left_as_it_is(n):
    t, true = motion(1.0)
    part = {name: values[:n] for name, values in true.items()}
    corrected = DriftCorrection().moving(t[:n], part, ALL)
    assert all(np.array_equal(corrected[name], part[name]) for name in part)


def test_three_samples_show_a_drift():
    t, still = DT_S * np.arange(3), np.zeros((3, 2))
    corrected = DriftCorrection().moving(t, {"q": still + 0.5 * t[:, None] ** 2, "dq": still + t[:, None]}, ALL)
    assert np.abs(corrected["dq"]).max() < t[-1]


def test_a_whole_recording_is_corrected_piece_by_piece():
    t, true = motion(3.0)
    rest, gap = 500, 0.5
    n = len(t)
    rows = 2 * n + 3 * rest
    clock = DT_S * np.arange(rows) + 100.0
    q_error, columns = np.array([0.05, -0.1]), {}
    drift = drifting(t, true, q_error, 0.02)
    for name in ("q", "dq", "ddq", "points"):
        still = np.zeros((rest, *drift[name].shape[1:]))
        moved = drift[name][-1] if name in ("q", "points") else 0.0
        parts = [still, drift[name], still + moved, drift[name] + moved, still + 2 * moved]
        columns[name] = np.concatenate(parts)
    begin = 100.0 + gap
    windows = [(begin, begin + n * DT_S), (begin + (n + rest) * DT_S, begin + (2 * n + rest) * DT_S)]
    corrected = without_drift(clock, columns, windows, ALL)
    assert {name: len(values) for name, values in corrected.items()} == dict.fromkeys(columns, rows)
    assert np.array_equal(corrected["q"][:rest], columns["q"][:rest])
    goal = true["q"][-1]
    assert np.allclose(corrected["q"][rest + n], goal, atol=5e-3)  # without it: off by 0.2 and 0.4
    assert np.allclose(corrected["q"][-1], 2 * goal, atol=1e-2)
    jumps = np.abs(np.diff(corrected["q"], axis=0)).max()
    assert jumps <= np.abs(np.diff(columns["q"], axis=0)).max()
    untouched = without_drift(clock, columns, [], ALL)
    assert all(np.array_equal(untouched[name], columns[name]) for name in columns)


@pytest.mark.parametrize("method", ["filter", "smooth"])
def test_only_the_sensors_paths_drift_where_the_angles_do_not(method):
    t, true = motion(3.0)
    drift = drifting(t, true, np.array([0.1, -0.1]), 0.05)
    correction, families = DriftCorrection(), dead_reckoned(method)
    corrected, like_all = correction.moving(t, drift, families), DriftCorrection().moving(t, drift, ALL)
    assert all(np.array_equal(corrected[name], drift[name]) for name in ("q", "dq", "ddq", "ref"))
    assert np.array_equal(corrected["points"], like_all["points"])
    left, before = (np.abs(columns["points"] - true["points"]).max() for columns in (corrected, drift))
    assert left < 0.1 * before
    after = correction.resting({name: values[-1:] for name, values in drift.items()})
    assert np.array_equal(after["q"], drift["q"][-1:])
    assert np.allclose(after["points"], corrected["points"][-1], atol=1e-12)


def hand_made(n, dt_s, begun_s=0.0):
    """Return squares of their row's number, three columns at once."""
    t = begun_s + dt_s * np.arange(n)
    square = np.arange(n, dtype=float)[:, None] ** 2
    return t, {"q": square * [1.0, -2.0], "dq": np.zeros((n, 2)), "ddq": np.zeros((n, 2)), "ref": square}


@pytest.mark.parametrize(
    ("n", "dt_s", "left"),
    [
        (3, 0.5, 1.0 / 0.5),  # from the first to the last but one: there are no others
        (3, 0.001, 1.0 / 0.001),
        (4, 0.5, 3.0 / 0.5),
        (4, 0.001, 4.0 / 0.002),
        (17, 1.0 / 128.0, (15.0**2 - 13.0**2) * 64.0),  # over a fiftieth of a second
        (17, 1.0 / 64.0, (15.0**2 - 14.0**2) * 64.0),
        (33, 1.0 / 256.0, (31.0**2 - 26.0**2) * 256.0 / 5.0),
    ],
)
def test_the_velocity_that_is_left_is_that_before_the_end(n, dt_s, left):
    t, columns = hand_made(n, dt_s, 100.0)
    correction = DriftCorrection()
    found = correction.moving(t, columns, [("q", "dq", "ddq")])
    s, c = dt_s * np.arange(n)[:, None], left * np.array([1.0, -2.0]) / (dt_s * (n - 1))
    np.testing.assert_allclose(found["q"], columns["q"] - c * s**2 / 2, rtol=1e-9)
    np.testing.assert_allclose(found["dq"], -c * s, rtol=1e-9)
    np.testing.assert_allclose(found["ddq"], np.tile(-c, (n, 1)), rtol=1e-9)
    assert np.array_equal(found["ref"], columns["ref"])
    shift = c * s[-1] ** 2 / 2
    np.testing.assert_allclose(correction.resting({"q": np.zeros((1, 2))})["q"], -shift[None], rtol=1e-9)
    again = correction.moving(t, columns, [("q", "dq", "ddq")])
    np.testing.assert_allclose(again["q"], found["q"] - shift, rtol=1e-9)
    np.testing.assert_allclose(correction.resting({"q": np.ones((1, 2))})["q"], 1.0 - 2.0 * shift[None], rtol=1e-9)


def test_windows_begin_and_end_at_the_rows_of_their_times():
    t, columns = hand_made(40, 0.25)
    part = {"q": columns["q"]}
    found = without_drift(t, part, [(2.5, 5.0), (5.0, 7.5)], [("q",)])["q"]
    one = DriftCorrection()
    rows = [part["q"][a:b] for a, b in ((0, 10), (10, 20), (20, 30), (30, 40))]
    expected = [
        rows[0],
        one.moving(t[10:20], {"q": rows[1]}, [("q",)])["q"],
        one.moving(t[20:30], {"q": rows[2]}, [("q",)])["q"],
        one.resting({"q": rows[3]})["q"],
    ]
    np.testing.assert_array_equal(found, np.concatenate(expected))
