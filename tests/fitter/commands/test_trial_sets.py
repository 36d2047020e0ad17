"""Learning and evaluating trials, kept apart."""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.commands.trial_sets import trial_sets
from fitter.data.motion_file import write_motion
from fitter.data.trials import load_trials
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")
CHOSEN = (None, None)


def asked(evaluate=()):
    """Return the options of a command that reads trials."""
    return argparse.Namespace(evaluate=list(evaluate), columns=None, rate_hz=None, as_tracked=False)


def sets(learn, evaluate):
    return trial_sets(asked(evaluate), ARM, learn, CHOSEN)


def names(trials):
    return [trial.name for trial in trials]


def test_files_are_what_they_are_given_for(trial_files):
    learn, evaluate = trial_files
    first, second = sets([learn], [evaluate])
    assert (names(first), names(second)) == (["learn/1", "learn/2"], ["evaluate/3"])
    assert {(t.cutoff_hz, t.band_hz) for t in (*first, *second)} == {(first[0].cutoff_hz, first[0].band_hz)}
    assert sets([learn], [])[1] == []


def test_a_recording_keeps_its_evaluating_motions_back(recording):
    for source in (recording, recording.parent):
        learn, evaluate = sets([source], [])
        assert (names(learn), names(evaluate)) == (["day/1", "day/2"], ["day/3"])
        assert evaluate[0].band_hz == learn[0].band_hz
        (again,) = load_trials(
            [recording], 2, arm=ARM, role="evaluate", cutoff_hz=learn[0].cutoff_hz, band_hz=learn[0].band_hz
        )
        for name, values in vars(replace(again, number=3)).items():  # it is the third of the run
            assert np.array_equal(getattr(evaluate[0], name), values), name


def test_files_beside_a_recording_are_learnt_from(recording, trial_files):
    learn, evaluate = sets([recording, trial_files[0]], [])
    assert names(learn) == ["day/1", "day/2", "learn/1", "learn/2"] and names(evaluate) == ["day/3"]


def test_a_recording_may_be_for_learning_or_evaluating_as_a_whole(recording, trial_files):
    learn, evaluate = sets([recording], [trial_files[1]])
    assert names(learn) == ["day/1", "day/2", "day/3"] and names(evaluate) == ["evaluate/3"]
    learn, evaluate = sets([trial_files[0]], [recording])
    assert names(evaluate) == ["day/1", "day/2", "day/3"]


def test_no_file_is_in_both_sets(trial_files, tmp_path, monkeypatch):
    learn, _ = trial_files
    write_motion(tmp_path / "a.npz", {"t": 0.01 * np.arange(50), "q": np.zeros((50, 2))})
    monkeypatch.chdir(tmp_path)
    for first, second in (([learn], [learn]), ([tmp_path], [Path("a.npz")]), ([Path("a.npz")], [tmp_path])):
        with pytest.raises(ConfigError, match="is learnt from, expected trials that are not"):
            sets(first, second)
