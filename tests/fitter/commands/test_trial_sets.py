"""Learning and evaluating trials, kept apart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fitter.commands.trial_sets import trial_sets
from fitter.data.motion_file import write_motion
from fitter.data.trials import load_trials
from limbcal.errors import ConfigError


@pytest.fixture
def load():
    def read(sources, role, filters):
        cutoff_hz, band_hz = filters or (None, None)
        return load_trials(sources, 2, role=role, cutoff_hz=cutoff_hz, band_hz=band_hz)

    return read


def names(trials):
    return [trial.name for trial in trials]


def test_files_are_what_they_are_given_for(load, trial_files):
    learn, evaluate = trial_files
    first, second = trial_sets(load, [learn], [evaluate])
    assert (names(first), names(second)) == (["learn/1", "learn/2"], ["evaluate/3"])
    assert {(t.cutoff_hz, t.band_hz) for t in (*first, *second)} == {(first[0].cutoff_hz, first[0].band_hz)}
    assert trial_sets(load, [learn], [])[1] == []


def test_a_recording_keeps_its_evaluating_motions_back(load, recording):
    for source in (recording, recording.parent):
        learn, evaluate = trial_sets(load, [source], [])
        assert (names(learn), names(evaluate)) == (["day/1", "day/2"], ["day/3"])
        assert evaluate[0].band_hz == learn[0].band_hz
        (again,) = load([recording], "evaluate", (learn[0].cutoff_hz, learn[0].band_hz))
        for name, values in vars(replace(again, number=3)).items():  # it is the third of the run
            assert np.array_equal(getattr(evaluate[0], name), values), name


def test_files_beside_a_recording_are_learnt_from(load, recording, trial_files):
    learn, evaluate = trial_sets(load, [recording, trial_files[0]], [])
    assert names(learn) == ["day/1", "day/2", "learn/1", "learn/2"] and names(evaluate) == ["day/3"]


def test_a_recording_may_be_for_learning_or_evaluating_as_a_whole(load, recording, trial_files):
    learn, evaluate = trial_sets(load, [recording], [trial_files[1]])
    assert names(learn) == ["day/1", "day/2", "day/3"] and names(evaluate) == ["evaluate/3"]
    learn, evaluate = trial_sets(load, [trial_files[0]], [recording])
    assert names(evaluate) == ["day/1", "day/2", "day/3"]


def test_no_file_is_in_both_sets(load, trial_files, tmp_path, monkeypatch):
    learn, _ = trial_files
    write_motion(tmp_path / "a.npz", {"t": 0.01 * np.arange(50), "q": np.zeros((50, 2))})
    monkeypatch.chdir(tmp_path)
    for first, second in (([learn], [learn]), ([tmp_path], [Path("a.npz")]), ([Path("a.npz")], [tmp_path])):
        with pytest.raises(ConfigError, match="is learnt from, expected trials that are not"):
            trial_sets(load, first, second)
