"""Columns of gyroscopes beside those of accelerometers: of all, some or none of the sensors, in rad/s."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Gyroscope
from fitter.data.motion_file import write_motion
from fitter.data.plausibility.refusal import Refusal
from fitter.data.raw import RawRun, load_raw
from limbcal.errors import ConfigError, DataError
from protocol.message import RAW, encode
from protocol.recording import RecordingWriter

SENSORS = ("s1", "s2")
N, RATE_HZ = 400, 100.0


def columns(*gyros: str, size: float = 1.0) -> dict[str, np.ndarray]:
    """Return readings that tell their own number: accelerations, and rates of these sensors."""
    t = np.arange(N) / RATE_HZ
    names = [f"{sensor}{axis}" for sensor in (*SENSORS, *(f"{name}g" for name in gyros)) for axis in "xyz"]
    return {"t": t} | {name: size * (k + np.sin(t + k)) for k, name in enumerate(names)}


def load(path, table, mapping=None, **options) -> RawRun:
    write_motion(path / "raw.csv", table)
    (run,) = load_raw([path / "raw.csv"], SENSORS, 2, mapping, **options)
    return run


@pytest.mark.parametrize("gyros", [(), ("s1",), ("s2",), ("s1", "s2")])
def test_sensors_may_have_one(tmp_path, gyros) -> None:
    table = columns(*gyros)
    run = load(tmp_path, table)
    assert run.gyros == gyros and run.a.shape == (N, 6)
    if gyros:
        assert run.w is not None
        np.testing.assert_array_equal(run.w, np.column_stack(list(table.values())[7:]))
    else:
        assert run.w is None
    readings = run.readings(RATE_HZ)
    assert readings.values.shape == (N, 6 + 3 * len(gyros))
    assert [block.w.shape for block in run.blocks(300)] == [(300, 3 * len(gyros)), (100, 3 * len(gyros))]


def test_a_part_of_one_is_refused(tmp_path) -> None:
    table = columns("s1")
    del table["s1gy"]
    with pytest.raises(DataError, match=r"raw\.csv: no column 's1gy' beside s1gx, s1gz among its columns"):
        load(tmp_path, table)


def test_degrees_are_converted_where_they_are_stated(tmp_path) -> None:
    table = columns("s1", "s2")
    mapping = "s1gx=s1gx:deg,s1gy=s1gy:deg/s,s1gz=s1gz:dps"
    run = load(tmp_path, table, mapping)
    plain = np.column_stack(list(table.values())[7:])
    np.testing.assert_allclose(run.w, plain * np.repeat([np.pi / 180.0, 1.0], 3))
    renamed = {name.replace("s2gx", "s2gx [deg/s]"): values for name, values in table.items()}
    np.testing.assert_allclose(load(tmp_path, renamed).w[:, 3], plain[:, 3] * np.pi / 180.0)
    with pytest.raises(ConfigError, match="s1gx cannot be in m/s2, expected one of"):
        load(tmp_path, table, "s1gx=s1gx:m/s2")
    with pytest.raises(ConfigError, match="s1x cannot be in deg/s"):
        load(tmp_path, table, "s1x=s1x:deg/s")


def test_a_mapping_names_them_and_must_find_them(tmp_path) -> None:
    table = {name.replace("s1g", "gyr_"): values for name, values in columns("s1").items()}
    run = load(tmp_path, table, "s1gx=gyr_x,s1gy=gyr_y,s1gz=gyr_z")
    assert run.gyros == ("s1",)
    np.testing.assert_array_equal(run.w[:, 2], table["gyr_z"])
    with pytest.raises(DataError, match="no column 'gyr_w'"):
        load(tmp_path, table, "s1gx=gyr_w,s1gy=gyr_y,s1gz=gyr_z")


def test_one_file_a_sensor_may_hold_its_gyroscope(tmp_path) -> None:
    t = np.arange(N) / RATE_HZ
    for k, sensor in enumerate(SENSORS):
        own = {name: np.sin(t + k + j) for j, name in enumerate(("ax", "ay", "az"))}
        if sensor == "s2":
            own |= {name: np.cos(t + j) for j, name in enumerate(("gx", "gy", "gz"))}
        write_motion(tmp_path / f"{sensor}.csv", {"t": t} | own)
    (run,) = load_raw([tmp_path], SENSORS, 2)
    assert run.gyros == ("s2",) and run.a.shape == (N, 6)
    np.testing.assert_allclose(run.w, np.column_stack([np.cos(t + j) for j in range(3)]))
    np.testing.assert_allclose(run.a[:, 3:], np.column_stack([np.sin(t + 1 + j) for j in range(3)]))


def test_a_sensor_may_be_called_as_the_gyroscope_of_another(tmp_path) -> None:
    """Then those columns are its accelerations."""
    t = np.arange(N) / RATE_HZ
    table = {"t": t} | {
        f"{s}{axis}": t + k for k, (s, axis) in enumerate((s, a) for s in ("leg", "le") for a in "xyz")
    }
    write_motion(tmp_path / "raw.csv", table)
    (run,) = load_raw([tmp_path / "raw.csv"], ("leg", "le"), 2)
    assert run.gyros == () and run.a.shape == (N, 6)


def test_rates_no_chip_measures_are_questioned(tmp_path) -> None:
    arm = load_arm("dd-arm-vertical")
    arm = replace(arm, sensors=arm.sensors[:2], tip=None)
    table = columns("s1")
    table |= {name: np.full(N, 9.80665 * (name[-1] == "y")) for name in table if len(name) == 3}
    table |= {name: 60.0 * np.sin(table["t"]) for name in table if len(name) == 4}
    with pytest.raises(Refusal, match=r"gyroscope of sensor 's1' reads up to 60: is it in deg/s\?"):
        load(tmp_path, table, arm=arm)
    assert np.abs(load(tmp_path, table, "s1gx=s1gx:deg,s1gy=s1gy:deg,s1gz=s1gz:deg", arm=arm).w).max() < 1.1


def test_some_of_them_can_be_kept(tmp_path) -> None:
    run = load(tmp_path, columns("s1", "s2"))
    kept = run.with_gyros({"s2"})
    assert kept.gyros == ("s2",)
    np.testing.assert_array_equal(kept.w, run.w[:, 3:])
    assert run.with_gyros(()).w is None


@pytest.mark.parametrize("sensors", [("s2",), ("s1", "s2")])
def test_a_recording_has_them_behind_all_accelerations(tmp_path, sensors) -> None:
    arm = load_arm("dd-arm")
    turned = {name: Gyroscope() for name in sensors}
    triads = tuple(replace(one, gyroscope=turned.get(one.name)) for one in arm.sensors[:2])
    a = 0.1 * np.random.default_rng(0).normal(size=(N, 6 + 3 * len(sensors)))
    a[:, 2:6:3] += 9.81
    fields = {"sample0": 0, "t0_ns": 10**18, "dt_s": 1.0 / RATE_HZ, "n": N, "a": a}
    with RecordingWriter(tmp_path / "run.mcap", "schema = 1", "", clock=lambda: 0.0) as writer:
        writer.write(RAW, encode(RAW, fields)[1], 0)
    (run,) = load_raw([tmp_path / "run.mcap"], SENSORS, 2, arm=replace(arm, sensors=triads))
    assert run.gyros == sensors and run.w is not None
    np.testing.assert_array_equal(run.a, a[:, :6])
    np.testing.assert_array_equal(run.w, a[:, 6:])
