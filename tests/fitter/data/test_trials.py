"""Trials from end to end, and column by column."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.data.motion_file import write_motion
from fitter.data.trial import Trial
from fitter.data.trial_filter import TRIM_SHARE, lowpass_trial
from fitter.data.trials import load_trials, to_trials
from limbcal.errors import ConfigError, DataError
from tests.fitter.data.random_columns import Q, uniform

DT_S = 0.002
T = DT_S * np.arange(3000)
OMEGA = 2 * np.pi * np.array([0.6, 1.7, 3.1])
SIZE = np.array([0.8, 0.3, 0.1])
PHASE = np.array([[0.0, 1.0, 2.0], [0.5, 2.5, 4.0]])


def motion(t, order=0):
    """Two joints swinging in three frequencies up to 3.1 Hz, or a derivative of that."""
    angle = t[:, None, None] * OMEGA + PHASE + order * np.pi / 2
    return (SIZE * OMEGA**order * np.sin(angle)).sum(-1)


def written(tmp_path, columns, name="run.parquet"):
    path = tmp_path / name
    write_motion(path, columns)
    return path


def test_derivatives_that_are_there_are_used_as_they_are(tmp_path):
    columns = {"q": motion(T), "dq": motion(T, 1), "ddq": motion(T, 2), "tau": motion(T), "ref": motion(T)}
    (trial,) = load_trials([written(tmp_path, {"t": T, **columns})], 2)
    for name, values in columns.items():
        assert np.array_equal(getattr(trial, name), values)
    assert trial.notes == ()
    assert trial.dt_s == DT_S
    assert trial.tip is None


def test_clean_angles_give_exact_derivatives(tmp_path):
    (trial,) = load_trials([written(tmp_path, {"t": T, "q": motion(T)})], 2)
    start = np.argmin(np.abs(motion(T) - trial.q[0]).sum(1))
    t = T[start : start + len(trial.t)]
    assert trial.t[0] == 0.0
    for order, name in enumerate(("q", "dq", "ddq")):
        error = np.abs(getattr(trial, name) - motion(t, order))[10:-10].max()
        assert error < 2e-3 * np.abs(motion(T, order)).max()


def test_noise_of_an_encoder_is_kept_out_of_the_acceleration(tmp_path):
    step = 3.8e-4
    path = written(tmp_path, {"t": T, "q": np.round(motion(T) / step) * step, "tau": motion(T)})
    (trial,) = load_trials([path], 2)
    assert 1.5 * 3.1 < trial.cutoff_hz < 12.0
    assert trial.band_hz == pytest.approx(trial.cutoff_hz * 4 / 9)
    trim = (len(T) - len(trial.t)) // 2
    inner = slice(trim, trim + len(trial.t))
    truth = motion(T, 2)[inner]
    error = np.sqrt(np.mean((trial.ddq - truth) ** 2))
    assert error < 0.01 * truth.std()
    assert "dq, ddq derived from q" in trial.notes[0].text
    assert "trimmed at each end" in trial.notes[1].text
    plain = np.gradient(np.gradient(np.round(motion(T) / step) * step, DT_S, axis=0), DT_S, axis=0)
    assert np.sqrt(np.mean((plain[inner] - truth) ** 2)) > 40 * error


def test_all_measured_columns_pass_the_same_filter_and_the_target_none(tmp_path):
    q = motion(T) + 1e-3 * np.random.default_rng(0).normal(size=(len(T), 2))
    path = written(tmp_path, {"t": T, "q": q, "dq": q, "tau": q, "tip": np.c_[q, q[:, 0]], "ref": q})
    (trial,) = load_trials([path], 2, cutoff_hz=5.0)
    assert np.array_equal(trial.q, trial.tau) and np.array_equal(trial.q, trial.dq)
    assert np.array_equal(trial.tip[:, :2], trial.q)
    trim = (len(T) - len(trial.t)) // 2
    assert np.array_equal(trial.ref, q[trim : len(T) - trim])


def test_a_regressor_filtered_as_the_torque_leaves_no_residual(tmp_path):
    """What `Trial.lowpass` is for: an equation with Coulomb friction in it stays exact."""
    columns = {"t": T, "q": motion(T), "dq": motion(T, 1), "ddq": motion(T, 2)}
    tau = 0.2 * columns["ddq"] + 1.5 * np.sin(columns["q"]) + 0.3 * np.sign(columns["dq"])
    (trial,) = load_trials([written(tmp_path, {**columns, "tau": tau})], 2, cutoff_hz=6.0)
    rows = np.stack([trial.ddq, np.sin(trial.q), np.sign(trial.dq)], axis=-1)
    residual = trial.lowpass(trial.tau) - trial.lowpass(rows) @ np.array([0.2, 1.5, 0.3])
    assert np.abs(residual).max() < 1e-9
    assert len(residual) == len(trial.t)


def test_a_target_is_filtered_as_it_is_held(tmp_path):
    """From one sample to the next: as seen by the samples it comes half a step late."""
    ref = np.column_stack([np.full(len(T), 0.7), 0.5 * T])
    (trial,) = load_trials([written(tmp_path, {"t": T, "q": motion(T), "ref": ref})], 2, cutoff_hz=10.0)
    inner = slice(50, -50)  # what the file's first and last rows are held to be shows near them
    np.testing.assert_allclose(trial.ref_filtered[inner, 0], 0.7, rtol=0, atol=1e-9)
    late = trial.ref[inner, 1] - trial.ref_filtered[inner, 1]
    np.testing.assert_allclose(late, 0.5 * DT_S / 2.0, rtol=0, atol=1e-6)


def test_drives_are_kept_for_the_whole_trial(tmp_path):
    on = np.repeat([1.0, 0.0], [2000, 1000])[:, None] * np.ones(2)
    columns = {"t": T, "q": motion(T), "ref": motion(T), "on": on, "kp": np.full((len(T), 2), 3.0)}
    (trial,) = load_trials([written(tmp_path, columns)], 2, cutoff_hz=10.0)
    np.testing.assert_array_equal(trial.whole["on"], on)
    np.testing.assert_array_equal(trial.whole["kp"], 3.0)
    np.testing.assert_array_equal(trial.drives.on, on[trial.trimmed : len(T) - trial.trimmed] > 0.5)


def test_noise_alone_does_not_trim_a_trial_away(tmp_path):
    q = 1e-3 * np.random.default_rng(0).normal(size=(len(T), 2))
    (trial,) = load_trials([written(tmp_path, {"t": T, "q": q})], 2)
    assert trial.cutoff_hz == pytest.approx(1.0 / (TRIM_SHARE * len(T) * DT_S))


def test_lowpass_trial_filters_everything_alike(tmp_path):
    columns = {"t": T, "q": motion(T), "dq": motion(T, 1), "ddq": motion(T, 2), "tau": motion(T), "ref": motion(T)}
    (trial,) = load_trials([written(tmp_path, columns)], 2)
    filtered = lowpass_trial(trial, 20.0)
    lengths = {
        len(getattr(filtered, f.name)) for f in fields(Trial) if isinstance(getattr(filtered, f.name), np.ndarray)
    }
    assert len(lengths) == 1 and lengths.pop() < len(T)
    assert np.array_equal(filtered.q, filtered.tau) and np.array_equal(filtered.q, filtered.ref)
    assert filtered.t[0] == 0.0
    assert filtered.lowpass(filtered.q) is not None and len(filtered.lowpass(filtered.q)) == len(filtered.q)
    trim = (len(T) - len(filtered.t)) // 2
    assert (filtered.trimmed, filtered.began_s) == (trim, pytest.approx(trim * DT_S))
    assert lowpass_trial(filtered, 20.0).began_s == pytest.approx(2 * trim * DT_S)
    assert np.abs(filtered.ddq - motion(T, 2)[trim : len(T) - trim]).max() < 1e-3 * np.abs(motion(T, 2)).max()


@settings(max_examples=15, deadline=None)
@given(st.floats(0.0, 0.8), st.integers(0, 2**32 - 1), st.sampled_from([".csv", ".npz"]))
def test_uneven_stamps_change_nothing(tmp_path_factory, jitter, seed, suffix):
    steps = DT_S * (1 + jitter * np.random.default_rng(seed).uniform(-0.7, 0.7, 2999))
    t = np.concatenate([[0.0], np.cumsum(steps)])
    path = written(tmp_path_factory.mktemp("uneven"), {"t": 100.0 + t, "q": motion(t)}, f"run{suffix}")
    (trial,) = load_trials([path], 2, rate_hz=500.0, cutoff_hz=50.0)
    trimmed_s = float(trial.notes[-1].text.split()[0])
    start = round(trimmed_s / DT_S)
    truth = motion(DT_S * (start + np.arange(len(trial.t))), 2)
    assert np.abs(trial.ddq - truth).max() < 0.01 * np.abs(truth).max()


def test_a_set_is_files_folders_and_trials(tmp_path):
    short = slice(0, 500)
    part = {"t": T[short], "q": motion(T[short])}
    written(tmp_path, part, "b.csv")
    written(tmp_path, part | {"trial": np.repeat([1, 2], 250)}, "a.npz")
    (tmp_path / "other").mkdir()
    written(tmp_path / "other", part, "b.csv")
    trials = load_trials([tmp_path, tmp_path / "other" / "b.csv"], 2)
    assert [trial.name for trial in trials] == ["a/1", "a/2", "b", "b"]
    assert len({trial.cutoff_hz for trial in trials}) == 1
    assert all(trial.t[0] == 0.0 for trial in trials)


def test_infinity_switches_the_filters_off(tmp_path):
    q = motion(T) + 1e-3 * np.random.default_rng(0).normal(size=(len(T), 2))
    (trial,) = load_trials([written(tmp_path, {"t": T, "q": q})], 2, cutoff_hz=np.inf)
    assert np.array_equal(trial.q, q)
    assert trial.lowpass(q) is not None and len(trial.lowpass(q)) == len(q)
    assert "unfiltered" in trial.notes[0].text


def test_what_cannot_be_used_is_said(tmp_path):
    path = written(tmp_path, {"t": T[:9], "q": motion(T[:9])}, "run.csv")
    with pytest.raises(DataError, match="trial 'run' has 9 samples, expected at least 16"):
        load_trials([path], 2)
    with pytest.raises(ConfigError, match="cutoff_hz is 0"):
        load_trials([path], 2, cutoff_hz=0)
    with pytest.raises(ConfigError, match="band_hz is -1"):
        load_trials([path], 2, band_hz=-1)
    with pytest.raises(ConfigError, match="no role"):
        load_trials([path], 2, "angle=q{j}")
    with pytest.raises(DataError, match="the arm has 1 joint"):
        load_trials([path], 1)


def test_a_corner_below_one_period_is_refused(tmp_path):
    path = written(tmp_path, {"t": T, "q": motion(T)})
    with pytest.raises(ConfigError, match="cutoff_hz is 1e-09"):
        load_trials([path], 2, cutoff_hz=1e-9)


@pytest.mark.parametrize(("periods", "enough"), [(0.99, False), (1.01, True)])
def test_the_longest_trial_holds_a_period_of_the_corner(periods, enough):
    motions = [uniform(q=Q).measured, uniform(q=Q).measured.rows(0, 500, "short")]
    if enough:
        assert len(to_trials(motions, cutoff_hz=periods / 2.0)) == 2
    else:
        with pytest.raises(ConfigError, match=r"cutoff_hz is 0.495, expected at least 0.5: one period"):
            to_trials(motions, cutoff_hz=periods / 2.0)
    assert to_trials(motions, cutoff_hz=9.0)[1].band_hz == pytest.approx(4.0)
    assert to_trials(motions, cutoff_hz=9.0, band_hz=2.5)[1].band_hz == 2.5
