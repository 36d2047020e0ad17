"""Raw accelerations from files, with gaps."""

import numpy as np
import pytest

from fitter.data.gaps import Gap
from fitter.data.motion_file import write_motion
from fitter.data.raw import RawRun, load_raw
from limbcal.errors import ConfigError, DataError

SENSORS = ("s1", "s2")
AXES = [f"{sensor}{axis}" for sensor in SENSORS for axis in "xyz"]
RATE_HZ = 32000.0


def raw_columns(index, extra=()):
    """Make readings that tell their own number, on a clock of 32 kHz."""
    index = np.asarray(index)
    columns = {"t": index / RATE_HZ, **{axis: 10.0 * index + k for k, axis in enumerate(AXES)}}
    return columns | {name: index * 0.001 for name in extra}


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz"])
def test_readings_with_truth_and_target(tmp_path, suffix):
    path = tmp_path / f"raw{suffix}"
    write_motion(path, raw_columns(np.arange(1000), extra=("q1", "q2", "ref1", "ref2")))
    (run,) = load_raw([path], SENSORS, 2)
    assert run.a.shape == (1000, 6)
    assert run.a.flags.c_contiguous
    assert run.a[7].tolist() == [70, 71, 72, 73, 74, 75]
    assert np.isclose(run.rate_hz, RATE_HZ)
    assert run.q.shape == run.ref.shape == (1000, 2)
    assert run.gaps == () and run.notes == () and run.trial is None


def test_blocks_cover_everything_once_and_end_at_gaps(tmp_path):
    path = tmp_path / "raw.parquet"
    index = np.delete(np.arange(2000), slice(500, 820))
    write_motion(path, raw_columns(index))
    (run,) = load_raw([path], SENSORS, 2)
    blocks = list(run.blocks(300))
    assert [(block.row, len(block.a), block.lost) for block in blocks] == [
        (0, 300, 0),
        (300, 200, 0),
        (500, 100, 320),
        (600, 300, 0),
        (900, 300, 0),
        (1200, 300, 0),
        (1500, 180, 0),
    ]
    assert np.array_equal(np.concatenate([block.a for block in blocks]), run.a)
    assert blocks[2].t0_ns == round(820 / RATE_HZ * 1e9)
    assert run.lost == 320
    (note,) = run.notes
    assert (note.text, note.row) == ("320 samples lost in 1 gap(s), nothing put in their place", 501)
    assert np.isclose(run.rate_hz, RATE_HZ)


def test_trials_on_one_clock_are_one_run_and_else_several(tmp_path):
    one, several = tmp_path / "one.csv", tmp_path / "several.csv"
    columns = raw_columns(np.arange(200))
    labels = np.repeat([1, 2], 100)
    write_motion(one, columns | {"trial": labels})
    write_motion(several, columns | {"t": np.tile(columns["t"][:100], 2), "trial": labels})
    (run,) = load_raw([one], SENSORS, 2)
    assert run.trial.tolist() == ["1"] * 100 + ["2"] * 100
    first, second = load_raw([several], SENSORS, 2)
    assert [first.name, second.name] == ["several/1", "several/2"]
    assert second.a[0, 0] == 1000.0


def test_foreign_names_are_mapped_and_time_may_be_a_rate(tmp_path):
    path = tmp_path / "raw.csv"
    write_motion(path, {f"Acc_{axis}": np.arange(20.0) for axis in "XYZ"})
    (run,) = load_raw([path], ("s1",), 1, "s1x=Acc_X,s1y=Acc_Y,s1z=Acc_Z", rate_hz=60.0)
    assert np.isclose(run.rate_hz, 60.0)
    assert run.a.shape == (20, 3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"s2z": None}, "no column 's2z' beside s1x, s1y, s1z, s2x, s2y among its columns"),
        ({"t": None}, "no column 't' among its columns"),
        ({"s1y": [0.0, np.nan] + [0.0] * 18}, "column 's1y', row 2: found nothing or NaN"),
        ({"t": [0.0, 2.0, 1.0] + list(range(3, 20))}, "in row 3 time runs backwards from 2 s to 1 s"),
        ({"t": [0.0, 1.0, 1.0] + list(range(3, 20))}, "in row 3 time stands still at 1 s"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, change, said):
    path = tmp_path / "raw.csv"
    columns = raw_columns(np.arange(20)) | {k: None if v is None else np.array(v) for k, v in change.items()}
    write_motion(path, {name: values for name, values in columns.items() if values is not None})
    with pytest.raises(DataError) as caught:
        load_raw([path], SENSORS, 2)
    assert said in str(caught.value)
    assert "raw.csv" in str(caught.value)


def test_too_few_samples_and_roles_that_do_not_exist(tmp_path):
    path = tmp_path / "raw.npz"
    write_motion(path, raw_columns(np.arange(3)))
    with pytest.raises(DataError, match="run 'raw' has 3 samples, expected at least 16"):
        load_raw([path], SENSORS, 2)
    with pytest.raises(ConfigError, match="'s3x' is no role"):
        load_raw([path], SENSORS, 2, "s3x=a")


def test_a_leap_of_a_day_makes_two_runs(tmp_path):
    t = 0.001 * np.arange(4000)
    t[2500:] += 86400.0
    write_motion(tmp_path / "leap.csv", {"t": t} | {f"s1{axis}": np.ones(4000) for axis in "xyz"})
    first, second = load_raw([tmp_path / "leap.csv"], ["s1"], 2)
    assert (len(first.t), len(second.t)) == (2500, 1500)
    assert not first.lost and not second.lost and second.after_leap and not first.after_leap
    (note,) = first.notes
    assert note.kind == "gap" and note.row == 2501


@pytest.mark.parametrize(("n", "enough"), [(15, False), (16, True)])
def test_sixteen_samples_are_enough(tmp_path, n, enough):
    write_motion(tmp_path / "raw.npz", raw_columns(np.arange(n)))
    if enough:
        assert len(load_raw([tmp_path], SENSORS, 2)[0].t) == 16
    else:
        with pytest.raises(DataError, match="has 15 samples, expected at least 16"):
            load_raw([tmp_path], SENSORS, 2)


def test_a_clock_starts_anew_with_a_trial_alone(tmp_path):
    columns, once = raw_columns(np.arange(60)), raw_columns(np.arange(20))["t"]
    path = tmp_path / "raw.npz"
    write_motion(path, columns | {"t": np.tile(once, 3), "trial": np.repeat(["a", "b", "c"], 20)})
    runs = load_raw([path], SENSORS, 2)
    assert [(run.name, run.a[0, 0], len(run.t)) for run in runs] == [
        ("raw/a", 0.0, 20),
        ("raw/b", 200.0, 20),
        ("raw/c", 400.0, 20),
    ]
    assert not any(run.after_leap for run in runs)
    for labels in (np.repeat(["a", "b"], [20, 40]), np.repeat(["a", "b"], [40, 20])):
        write_motion(path, columns | {"t": np.tile(once, 3), "trial": labels})
        with pytest.raises(DataError, match="time runs backwards"):
            load_raw([path], SENSORS, 2)


def test_a_gap_is_noted_with_its_row_in_the_file(tmp_path):
    index = np.concatenate([np.arange(30), np.delete(np.arange(40), [9, 20, 21])])
    columns = raw_columns(index) | {"trial": np.repeat(["a", "b"], [30, 37])}
    write_motion(tmp_path / "raw.npz", columns)
    first, second = load_raw([tmp_path], SENSORS, 2)
    assert first.notes == () and first.lost == 0
    (note,) = second.notes
    assert (note.row, note.text) == (40, "3 samples lost in 2 gap(s), nothing put in their place")
    assert second.gaps == (Gap(9, 1), Gap(19, 2)) and second.rate_hz == pytest.approx(RATE_HZ)


def run_of(n, gaps=()):
    index = np.arange(float(n))
    return RawRun("run", 1000.0, 1e-3 * index, np.column_stack([index, -index, index]), gaps)


def test_blocks_are_of_65536_rows_unless_less_is_asked_for():
    blocks = list(run_of(65_537).blocks())
    assert [(block.row, len(block.a)) for block in blocks] == [(0, 65_536), (65_536, 1)]
    assert blocks[1].t0_ns == 65_536_000_000
    assert [(block.row, block.lost) for block in run_of(6, (Gap(4, 9),)).blocks(3)] == [(0, 0), (3, 0), (4, 9)]


def test_readings_are_at_most_at_the_rate_of_the_samples_and_lost_ones_none():
    run = run_of(4000, (Gap(2000, 500),))
    for rate_hz, factor in ((1000.0, 1), (5000.0, 1), (250.0, 4)):
        found = run.readings(rate_hz)
        assert found.factor == factor and found.dt_s == pytest.approx(1e-3 * factor)
        assert len(found.values) == pytest.approx(4500 / factor, abs=12)
        assert np.count_nonzero(~found.present) == pytest.approx(500 / factor, abs=40)
    with pytest.raises(DataError, match="run 'run': "):
        run_of(3).readings(1000.0)
