"""The corner of a set of trials, and its trials in stretches."""

import numpy as np
import pytest

from fitter.data.motion_file import write_motion
from fitter.data.motions import read_motions
from fitter.data.reading import Reading, find_corner_hz, stretches_of
from fitter.data.trials import load_trials, to_trials
from limbcal.errors import DataError
from protocol.tables.columns import parse_mapping


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two files of a swing with white noise, one of them of two trials."""
    folder = tmp_path_factory.mktemp("set")
    rng = np.random.default_rng(0)
    for name, n in (("a.csv", 3000), ("b.npz", 2000)):
        t = np.arange(n) * 2e-3
        q = np.sin(2.0 * np.pi * 0.7 * t)[:, None] * [1.0, 0.5] + 1e-4 * rng.normal(size=(n, 2))
        write_motion(folder / name, {"t": t, "q": q, "trial": np.arange(n) // 1500})
    return folder


def test_the_corner_is_that_of_trials_read_whole(folder):
    corner, samples = find_corner_hz([folder], 2)
    assert corner == load_trials([folder], 2)[0].cutoff_hz
    assert samples is None


@pytest.mark.parametrize(("values", "trials"), [(3000, 1), (6000, 2), (7000, 3)])
def test_a_part_of_the_set_is_enough_and_said(folder, monkeypatch, values, trials):
    monkeypatch.setattr("fitter.data.reading.CORNER_VALUES", values)
    motions = [
        motion
        for name in ("a.csv", "b.npz")
        for motion in read_motions(folder / name, 2, parse_mapping(None, 2), None, ("q",))
    ][:trials]
    expected = to_trials(motions)[0].cutoff_hz
    assert find_corner_hz([folder], 2) == (expected, sum(len(motion.t) for motion in motions))


def test_a_trackers_motion_is_not_filtered(recording):
    assert find_corner_hz([recording], 2) == (np.inf, None)


def test_a_trial_longer_than_a_stretch_is_parted(folder):
    reading = Reading(cutoff_hz=100.0, band_hz=50.0, stretch=1400)
    found = list(stretches_of([folder / "a.csv"], 2, reading))
    assert [s.motion.name for s in found if s.begins] == ["a/0", "a/1"]
    assert len(found) > 2
    assert sum(s.counted.stop - s.counted.start for s in found) == 3000


def test_motions_to_evaluate_with_are_none_to_learn_from(recording, tmp_path):
    assert len(list(stretches_of([recording], 2, Reading()))) == 2
    with pytest.raises(DataError, match="no such file"):
        find_corner_hz([tmp_path / "none.csv"], 2)


def test_the_corner_is_found_from_the_columns_nearest_to_an_acceleration(tmp_path, monkeypatch):
    t = np.arange(200) * 2e-3
    write_motion(tmp_path / "a.csv", {"t": t, "q": np.sin(t)[:, None], "dq": np.cos(t)[:, None]})
    seen = []
    monkeypatch.setattr(
        "fitter.data.reading.choose_cutoff_hz",
        lambda pieces: seen.extend(p.measured.columns for p in pieces) or 50.0,
    )
    assert find_corner_hz([tmp_path / "a.csv"], 1) == (50.0, None)
    assert [set(columns) for columns in seen] == [{"dq"}]
    assert {"q", "dq"} <= {*next(iter(stretches_of([tmp_path / "a.csv"], 1, Reading()))).motion.columns}
