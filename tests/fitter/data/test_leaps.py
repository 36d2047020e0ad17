"""Motions whose time leaps."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.leaps import split_at_leaps
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from limbcal.errors import DataError
from limbcal.note import Note


def leaping(*lengths, by=86400.0):
    t = np.concatenate([0.01 * np.arange(n) + k * by for k, n in enumerate(lengths)])
    return Measured("run", "run.csv", 0, t, {"q": np.sin(t)[:, None]})


def test_a_leap_parts_a_motion_and_is_said_with_its_row():
    first, second = split_at_leaps(leaping(60, 40))
    assert (len(first.t), len(second.t), second.first_row) == (60, 40, 60)
    assert (first.name, second.name) == ("run#1", "run#2")
    (note,) = first.notes
    assert not second.notes
    assert (note.kind, note.row, note.columns, note.source) == ("gap", 61, ("t",), "run.csv")
    assert "in row 61 t leaps from 0.59 to 86400 s" in note.text and note.text.endswith("into 2 runs")
    assert (note.from_s, note.to_s) == (pytest.approx(0.59), 86400.0)


def test_short_pieces_are_left_out_and_none_at_all_is_an_error():
    assert [len(piece.t) for piece in split_at_leaps(leaping(60, 5, 40))] == [60, 40]
    with pytest.raises(DataError, match="run.csv: in row 11 t leaps .* no piece has 16 samples"):
        split_at_leaps(leaping(10, 10))


@pytest.mark.parametrize("by", [86400.0, 1.7e9])
def test_trials_take_the_memory_of_their_samples(by):
    trials = to_trials([leaping(60, 40, by=by)], cutoff_hz=np.inf)
    assert sum(len(trial.t) for trial in trials) == 100


@pytest.mark.parametrize(("n", "kept"), [(15, [60]), (16, [60, 16])])
def test_sixteen_samples_are_a_piece(n, kept):
    pieces = split_at_leaps(leaping(60, n))
    assert [len(piece.t) for piece in pieces] == kept
    assert pieces[0].notes[0].text.endswith(f"into {len(kept)} run{'s' if len(kept) > 1 else ''}")


def test_every_leap_is_noted_once_behind_what_was_noted_before():
    earlier = Note("unit", "degrees", columns=("q1",))
    motion = replace(leaping(60, 5, 40), notes=(earlier,), first_row=7)
    first, second = split_at_leaps(motion)
    assert first.notes[0] == earlier and second.notes == ()
    assert [note.row for note in first.notes[1:]] == [68, 73]
    assert (first.first_row, second.first_row, second.name) == (7, 72, "run#2")


def test_a_motion_without_leaps_is_the_motion_and_time_must_rise():
    motion = leaping(60)
    assert split_at_leaps(motion) == [motion]
    with pytest.raises(DataError, match="in row 60 time stands still"):
        split_at_leaps(replace(motion, t=np.append(motion.t[:-1], motion.t[-2])))
