"""Files to sums: in stretches, by several processes and on a cluster, always the same."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from arm.newton_euler import inverse_dynamics
from arm.structural_parameters import structural_parameters
from fitter.data.derivatives import differentiate
from fitter.data.motion_file import write_motion
from fitter.data.reading import Reading, find_corner_hz
from fitter.data.trials import load_trials
from fitter.regression_sums import reduction
from fitter.regression_sums.reduction import reduce_file, reduce_trials
from fitter.regression_sums.saved_sums import save_sums
from fitter.regression_sums.torque_sums import add_up
from fitter.regression_sums.trial_sums import trial_sums
from limbcal.errors import ConfigError, DataError

LAW = load_arm("dd-arm")
MEASURED = replace(LAW, control=Control())
BASE = structural_parameters(LAW)
SUMS = ("gram", "moment", "power", "row", "torque", "count")
REST, RATE_HZ = 0.02, 500.0


def motion(n, seed):
    """Return a motion of a few sinusoids with noise on angle and torque, and steps for a target."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) / RATE_HZ
    hertz, phase = np.arange(1, 7) * 0.41, rng.uniform(0.0, 6.0, (2, 6))
    amplitude = rng.normal(size=(2, 6)) / np.arange(1, 7)
    q = np.sum(amplitude * np.sin(2.0 * np.pi * hertz * t[:, None, None] + phase), axis=2)
    dq, ddq = (differentiate(q, 1.0 / RATE_HZ, order) for order in (1, 2))
    tau = inverse_dynamics(LAW, q, dq, ddq) + 0.02 * rng.normal(size=q.shape)
    noisy = q + 1e-4 * rng.normal(size=q.shape)
    return {"t": t, "q": noisy, "dq": dq, "ddq": ddq, "tau": tau, "ref": np.round(q, 1)}


def without(columns, *names):
    return {name: values for name, values in columns.items() if name not in names}


@pytest.fixture(scope="module")
def long_motion():
    return motion(12_000, 0)


def whole_sums(arm, path, **options):
    trials = load_trials([path], 2, **options)
    return add_up([trial_sums(arm, BASE, trial, REST) for trial in trials]), trials[0]


@pytest.mark.parametrize("arm", [MEASURED, LAW], ids=["torque", "law"])
@pytest.mark.parametrize(
    ("suffix", "left_out", "rate_hz"),
    [
        (".csv", ("dq", "ddq"), None),
        (".parquet", ("ddq",), None),
        (".npz", (), None),
        (".npz", ("dq", "ddq"), 700.0),
        (".npz", ("dq", "ddq"), 250.0),
    ],
)
def test_a_file_in_stretches_gives_the_sums_of_the_whole(tmp_path, long_motion, arm, suffix, left_out, rate_hz):
    path = tmp_path / f"long{suffix}"
    write_motion(path, without(long_motion, *left_out))
    whole, trial = whole_sums(arm, path, rate_hz=rate_hz, cutoff_hz=30.0)
    reading = Reading(rate_hz=rate_hz, cutoff_hz=trial.cutoff_hz, band_hz=trial.band_hz, stretch=5000)
    parted = reduce_file(arm, REST, reading, [path])
    assert parted.sums.samples == whole.samples
    assert parted.trials == ("long",)
    for name in SUMS:
        found, expected = getattr(parted.sums.total(), name), getattr(whole.total(), name)
        assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()


def test_a_longer_file_takes_no_more_memory(tmp_path, monkeypatch):
    monkeypatch.setattr("fitter.data.reading.BLOCK_ROWS", 4096)
    peaks = []
    for repeats in (1, 6):
        part = motion(20_000, 0)
        stamps = np.arange(20_000 * repeats) / RATE_HZ
        columns = {name: np.tile(part[name], (repeats, 1)) for name in ("q", "dq", "ddq", "tau")}
        np.savez(
            tmp_path / "long.npz",
            t=stamps,
            **{f"{name}{j + 1}": values[:, j] for name, values in columns.items() for j in (0, 1)},
        )
        tracemalloc.start()
        reading = Reading(cutoff_hz=30.0, band_hz=13.0, stretch=10_000)
        reduced = reduce_file(MEASURED, REST, reading, [tmp_path / "long.npz"])
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert reduced.sums.samples == len(stamps)
    assert peaks[1] < 1.2 * peaks[0]


def test_jitter_and_holes_in_a_long_file(tmp_path, long_motion):
    rng = np.random.default_rng(3)
    t = long_motion["t"] + rng.uniform(-2e-4, 2e-4, 12_000)
    t[7000:] += 1.0
    path = tmp_path / "long.npz"
    write_motion(path, without(long_motion, "dq", "ddq") | {"t": t})
    whole, trial = whole_sums(MEASURED, path, cutoff_hz=30.0)
    reading = Reading(cutoff_hz=30.0, band_hz=trial.band_hz, stretch=5000)
    parted = reduce_file(MEASURED, REST, reading, [path])
    assert len(parted.trials) == 2
    assert parted.sums.samples == pytest.approx(whole.samples, abs=2)
    found, expected = parted.sums.total(), whole.total()
    assert np.abs(found.gram - expected.gram).max() < 1e-3 * np.abs(expected.gram).max()  # a sample more or less


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three short files and one of two trials, as `load_trials` reads them too."""
    folder = tmp_path_factory.mktemp("set")
    for seed, suffix in enumerate((".csv", ".npz", ".parquet")):
        write_motion(folder / f"run{seed}{suffix}", without(motion(1500, seed), "dq", "ddq"))
    two = without(motion(3000, 9), "dq", "ddq")
    write_motion(folder / "two.csv", two | {"trial": np.repeat([1, 2], 1500)})
    return folder


def saved_bytes(tmp_path, made):
    save_sums(tmp_path / "s.npz", made.saved)
    return (tmp_path / "s.npz").read_bytes()


@pytest.fixture(scope="module")
def alone(folder):
    """Return the sums that one process makes."""
    return reduce_trials(LAW, [folder])


def test_short_files_give_what_a_fit_of_the_trials_sees(folder, alone):
    whole, trial = whole_sums(LAW, folder)
    assert (alone.cutoff_hz, alone.band_hz) == (trial.cutoff_hz, trial.band_hz)
    assert alone.saved.trials == ("run0", "run1", "run2", "two/1", "two/2")
    for name in (*SUMS, "trial"):
        assert np.array_equal(getattr(alone.saved.sums, name), getattr(whole, name))
    assert any("derived from q" in note.text for note in alone.notes)


def test_two_processes_give_the_same_bytes(tmp_path, folder, alone):
    steps = []
    made = reduce_trials(LAW, [folder], workers=2, progress=lambda *done: steps.append(done))
    assert saved_bytes(tmp_path, made) == saved_bytes(tmp_path, alone)
    assert made.notes == alone.notes
    assert steps == [(k, 4) for k in range(1, 5)]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of the cluster's own libraries
def test_a_dask_cluster_gives_the_same_bytes(tmp_path, folder, alone):
    distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    with distributed.LocalCluster(  # of threads that talk as machines would
        n_workers=2,
        threads_per_worker=1,
        processes=False,
        protocol="tcp",
        host="127.0.0.1",
        dashboard_address=None,
        local_directory=str(tmp_path),
    ) as cluster:
        made = reduce_trials(LAW, [folder], dask=cluster.scheduler_address)
        with pytest.raises(DataError, match=r"bad.csv: row 2: column 'q1' holds 'x'"):
            (tmp_path / "bad.csv").write_text("t,q1,q2\n0,1,2\n1,x,2\n")
            reduce_trials(LAW, [tmp_path / "bad.csv"], cutoff_hz=10.0, dask=cluster.scheduler_address)
    assert saved_bytes(tmp_path, made) == saved_bytes(tmp_path, alone)


def test_the_corner_is_found_in_the_first_part_of_a_large_set(folder, monkeypatch):
    whole = find_corner_hz([folder], 2)
    assert whole[1] is None
    monkeypatch.setattr("fitter.data.reading.CORNER_VALUES", 5000)
    corner, samples = find_corner_hz([folder], 2)
    assert samples == 3000
    assert corner == pytest.approx(whole[0], rel=0.5)
    others = sorted(file for file in folder.iterdir() if file.name != "two.csv")
    made = reduction.reduce_trials(LAW, [folder / "two.csv", *others])
    assert any(f"Hz was found in the first {3000} samples" in note.text for note in made.notes)


def test_the_corner_of_a_file_longer_than_that(tmp_path, long_motion, monkeypatch):
    write_motion(tmp_path / "long.npz", without(long_motion, "dq", "ddq"))
    monkeypatch.setattr("fitter.data.reading.CORNER_VALUES", 8000)
    corner, samples = find_corner_hz([tmp_path / "long.npz"], 2)
    assert 4000 <= samples < 12_000
    assert corner == pytest.approx(load_trials([tmp_path / "long.npz"], 2)[0].cutoff_hz, rel=0.3)


def test_a_long_motion_to_an_unknown_target_is_no_motion(tmp_path, long_motion):
    write_motion(tmp_path / "long.npz", without(long_motion, "dq", "ddq", "ref"))
    reading = Reading(cutoff_hz=30.0, band_hz=12.0, stretch=5000)
    with pytest.raises(DataError, match="has no target; expected columns ref1"):
        reduce_file(LAW, REST, reading, [tmp_path / "long.npz"])


def test_evaluating_motions_of_a_recording_are_left_out(recording):
    made = reduce_trials(LAW, [recording])
    assert len(made.saved.trials) == 2
    assert np.isinf(made.cutoff_hz)
    whole = add_up([trial_sums(LAW, BASE, t) for t in load_trials([recording], 2, cutoff_hz=np.inf, role="learn")])
    assert np.array_equal(made.saved.sums.gram, whole.gram)


def test_wrong_columns_are_said_before_anything_is_read(folder):
    with pytest.raises(ConfigError, match="no role"):
        reduce_trials(LAW, [folder], columns="nonsense=x")


def test_a_file_shorter_than_a_period_of_the_corner_is_reduced(tmp_path, long_motion):
    named = without(long_motion, "dq", "ddq")
    for name, rows in (("long", slice(0, 4000)), ("short", slice(4000, 4040))):
        write_motion(tmp_path / f"{name}.npz", {role: values[rows] for role, values in named.items()})
    made = reduce_trials(MEASURED, [tmp_path], cutoff_hz=10.0)
    assert made.saved.trials == ("long", "short")
    with pytest.raises(ConfigError, match=r"cutoff_hz is 0.1, expected at least 0.125: one period"):
        reduce_trials(MEASURED, [tmp_path], cutoff_hz=0.1)
