"""One file per sensor."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fitter.data.derivatives import lowpass
from fitter.data.motion_file import write_motion
from fitter.data.raw import load_raw
from limbcal.errors import DataError

SENSORS = ("s1", "s2")


def readings(t, sensor):
    """Return smooth accelerations that every sensor has of its own."""
    return np.column_stack([np.sin(2.0 * t + sensor + axis) for axis in range(3)])


def write(path, t, sensor, names="xyz"):
    a = readings(t, sensor)
    write_motion(path, {"t": t} | {name: a[:, k] for k, name in enumerate(names)})


@pytest.mark.parametrize("names", ["xyz", ("ax", "ay", "az"), ("acc_x", "acc_y", "acc_z"), None])
def test_files_are_joined_on_one_clock(tmp_path, names):
    for k, sensor in enumerate(SENSORS, 1):
        axes = [f"{sensor}{axis}" for axis in "xyz"] if names is None else names
        write(tmp_path / f"{sensor}.csv", 0.01 * np.arange(500) + 0.0037 * k + 0.2 * k, k, axes)
    (run,) = load_raw([tmp_path], SENSORS, 2)
    assert run.t[0] >= 0.4 and run.t[-1] <= 5.2
    assert np.allclose(run.a, np.hstack([readings(run.t, 1), readings(run.t, 2)]), atol=1e-5)
    assert "joined on one clock" in run.notes[0].text and "resampled to 10 ms" in run.notes[0].text
    assert run.notes[0].kind == "joined"


def test_the_same_stamps_are_kept_as_they_are(tmp_path):
    t = 0.01 * np.arange(500)
    for k, sensor in enumerate(SENSORS, 1):
        write(tmp_path / f"walk_{sensor}.csv", t, k)
    (run,) = load_raw([tmp_path], SENSORS, 2)
    assert np.array_equal(run.t, t) and np.array_equal(run.a, np.hstack([readings(t, 1), readings(t, 2)]))


def test_a_faster_sensor_is_brought_to_the_rate_of_the_slower(tmp_path):
    write(tmp_path / "s1.csv", 0.01 * np.arange(500), 1)
    write(tmp_path / "s2.csv", 0.0025 * np.arange(2000), 2)
    (run,) = load_raw([tmp_path], SENSORS, 2)
    assert run.rate_hz == pytest.approx(100.0)
    inner = slice(50, -50)
    assert np.allclose(run.a[inner, 3:], readings(run.t, 2)[inner], atol=1e-3)


def test_what_the_slower_rate_cannot_carry_is_taken_off_the_faster_sensor(tmp_path):
    write(tmp_path / "s1.csv", 0.01 * np.arange(500), 1)
    t = 0.0025 * np.arange(2000)
    shaken = readings(t, 2) + 3.0 * np.sin(2.0 * np.pi * 130.0 * t)[:, None]
    write_motion(tmp_path / "s2.csv", {"t": t} | {name: shaken[:, k] for k, name in enumerate("xyz")})
    (run,) = load_raw([tmp_path], SENSORS, 2)
    inner = slice(50, -50)
    assert np.allclose(run.a[inner, 3:], readings(run.t, 2)[inner], atol=0.05)


def test_several_runs_are_told_by_their_names_or_folders(tmp_path):
    for run in ("one", "two"):
        for k, sensor in enumerate(SENSORS, 1):
            write(tmp_path / run / f"{sensor}.csv", 0.01 * np.arange(100) + 0.001 * k, k)
            write(tmp_path / f"{run}_{sensor}.csv", 0.01 * np.arange(100) + 0.001 * k, k)
    assert len(load_raw([tmp_path], SENSORS, 2)) == 2
    assert len(load_raw([tmp_path / "one", tmp_path / "two"], SENSORS, 2)) == 2


def test_a_hole_of_one_sensor_is_a_gap_and_a_leap_takes_no_memory(tmp_path):
    t = 0.01 * np.arange(500)
    write(tmp_path / "s1.csv", np.delete(t, slice(200, 230)), 1)
    write(tmp_path / "s2.csv", t + 0.003, 2)
    (run,) = load_raw([tmp_path], SENSORS, 2)
    assert 28 <= run.lost <= 32
    for k, sensor in enumerate(SENSORS, 1):
        write(tmp_path / f"{sensor}.csv", np.where(t < 2.5, t, t + 86400.0) + 0.003 * k, k)
    first, second = load_raw([tmp_path], SENSORS, 2)
    assert abs(len(first.t) - 250) <= 2 and abs(len(second.t) - 250) <= 2 and second.after_leap


def test_what_cannot_be_joined_is_said(tmp_path):
    t = 0.01 * np.arange(100)
    write(tmp_path / "s1.csv", t, 1)
    write(tmp_path / "s2.csv", t + 100.0, 2)
    with pytest.raises(DataError, match=r"s2.csv begins at 100 s, when .*s1.csv has ended at 0.99 s"):
        load_raw([tmp_path], SENSORS, 2)
    with pytest.raises(DataError, match=r"none has s3x, s3y, s3z, expected a file for sensor 's3' too"):
        load_raw([tmp_path], (*SENSORS, "s3"), 2)
    with pytest.raises(DataError, match=r"no column 's1x' among its columns t, x, y, z"):
        load_raw([tmp_path / "s1.csv"], SENSORS, 2)
    write(tmp_path / "again.csv", t, 2, ("s2x", "s2y", "s2z"))
    write(tmp_path / "more.csv", t, 2, ("s2x", "s2y", "s2z"))
    write(tmp_path / "first.csv", t, 1, ("s1x", "s1y", "s1z"))
    with pytest.raises(DataError, match="both have s2x, s2y, s2z, expected sensor 's2' once a run"):
        load_raw([tmp_path / name for name in ("first.csv", "again.csv", "more.csv")], SENSORS, 2)


def joined_of(folder, first, second):
    """Join two sensors' own stamps, and return their run; the second begins later where both do not."""
    write(folder / "s1.csv", np.asarray(first), 1)
    write(folder / "s2.csv", np.asarray(second), 2)
    (run,) = load_raw([folder], SENSORS, 2)
    return run


@pytest.mark.parametrize(("share", "kept"), [(0.0, True), (0.9e-3, True), (-0.9e-3, True), (1.1e-3, False)])
def test_stamps_that_agree_to_a_thousandth_of_a_step_are_the_same(tmp_path, share, kept):
    t = 0.01 * np.arange(100)
    run = joined_of(tmp_path, t, t + 0.01 * share)
    assert run.notes[0].text.startswith("joined: the files have the same time stamps") == kept
    assert np.array_equal(run.t, t) == kept
    assert np.array_equal(run.a[:, 3:], readings(t + 0.01 * share, 2)) == kept


@pytest.mark.parametrize("swapped", [False, True])
def test_the_common_clock_runs_from_the_last_beginning_to_the_first_end(tmp_path, swapped):
    early, late = 0.01 * np.arange(500), 0.2 + 0.01 * np.arange(600)
    run = joined_of(tmp_path, *((late, early) if swapped else (early, late)))
    np.testing.assert_allclose(run.t, 0.2 + 0.01 * np.arange(480), atol=1e-9)
    assert "from 0.2 to 4.99 s and resampled to 10 ms" in run.notes[0].text
    np.testing.assert_allclose(run.a, np.hstack([readings(run.t, 1), readings(run.t, 2)]), atol=1e-5)


@pytest.mark.parametrize(
    ("begins", "words"),
    [
        (0.99, "s2.csv begins at 0.99 s, when .*s1.csv has ended at 0.99 s: they do not overlap"),
        (0.85, "no 16 samples in a row at which every sensor reads"),
        (0.84, ""),
    ],
)
def test_sixteen_samples_must_be_common(tmp_path, begins, words):
    t = 0.01 * np.arange(100)
    if words:
        with pytest.raises(DataError, match=words):
            joined_of(tmp_path, t, begins + t)
    else:
        assert len(joined_of(tmp_path, t, begins + t).t) == 16


@pytest.mark.parametrize(("missing", "samples"), [(8, 499), (11, 487), (30, 468)])
@pytest.mark.parametrize("swapped", [False, True])
def test_of_more_than_ten_missing_steps_nothing_is_made_up(tmp_path, missing, samples, swapped):
    """From 1.99 s on; the instants of the other sensor lie 3 ms later than those of this one."""
    t = 0.01 * np.arange(500)
    two = np.delete(t, slice(200, 200 + missing)), t + 0.003
    run = joined_of(tmp_path, *(two[::-1] if swapped else two))
    assert len(run.t) == samples
    made_up = (run.t > 1.991) & (run.t < 1.989 + 0.01 * (missing + 1))
    assert made_up.any() == (missing < 10)


def test_holes_of_both_sensors_are_left_out(tmp_path):
    t = 0.01 * np.arange(500)
    run = joined_of(tmp_path, np.delete(t, np.r_[50:80, 300:330]), np.delete(t, np.r_[70:120, 400:450]))
    np.testing.assert_allclose(run.t, np.delete(t, np.r_[50:120, 300:330, 400:450]), atol=1e-9)


@pytest.mark.parametrize(("step_s", "filtered"), [(0.007, False), (0.0066, True), (0.004, True)])
def test_from_one_and_a_half_times_its_step_on_a_sensor_is_filtered(tmp_path, step_s, filtered):
    write(tmp_path / "s1.csv", 0.01 * np.arange(400), 1)
    t = step_s * np.arange(int(4.1 / step_s))
    noise = np.random.default_rng(0).normal(size=(len(t), 3))
    write_motion(tmp_path / "s2.csv", {"t": t} | {name: noise[:, k] for k, name in enumerate("xyz")})
    (run,) = load_raw([tmp_path], SENSORS, 2)
    seen = lowpass(noise, step_s, 0.4 / 0.01) if filtered else noise
    inner = slice(60, -60)
    np.testing.assert_allclose(run.a[inner, 3:], CubicSpline(t, seen)(run.t)[inner], atol=1e-6)


def test_a_name_within_another_is_none(tmp_path):
    t = 0.01 * np.arange(100)
    for name, sensor in (("walk_S1.csv", 1), ("walk_s10.csv", 2)):
        write(tmp_path / name, t, sensor)
    (run,) = load_raw([tmp_path], ("s1", "s10"), 2)
    assert np.array_equal(run.a, np.hstack([readings(t, 1), readings(t, 2)]))
    assert run.name == tmp_path.name


def test_the_file_that_ends_first_is_named(tmp_path):
    t = 0.01 * np.arange(100)
    write(tmp_path / "s1.csv", t, 1)
    write(tmp_path / "s2.csv", t + 100.0, 2)
    write(tmp_path / "s3.csv", np.r_[t[:-2], 1.5], 3)  # the last but one earlier than that of s1, the last later
    with pytest.raises(DataError, match=r"s2.csv begins at 100 s, when .*s1.csv has ended at 0.99 s"):
        load_raw([tmp_path], (*SENSORS, "s3"), 2)
