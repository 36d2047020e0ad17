"""One file per sensor."""

import numpy as np
import pytest

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
