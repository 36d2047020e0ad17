"""What the daemon recorded, back as motions."""

import numpy as np
import pytest

from fitter.data.raw import load_raw
from fitter.data.recordings import by_run, read_frames, read_raw_blocks
from fitter.data.trials import load_trials
from limbcal.errors import DataError
from protocol.message import FRAMES, RAW, TRIAL, encode
from protocol.recording import RecordingWriter

START_NS = 5_000_000_000
DT_S = 0.001
BLOCK = 10


def frames(frame0, gap=False, n_joint=2):
    """Ten frames whose angles tell their number."""
    number = frame0 + np.arange(BLOCK, dtype=float)
    q = np.repeat(number[:, None], n_joint, axis=1) * 1e-3
    return {
        "frame0": frame0,
        "t0_ns": START_NS + frame0 * 1_000_000,
        "dt_s": DT_S,
        "n": BLOCK,
        "method": "integrate",
        "q": q,
        "dq": np.ones_like(q),
        "ddq": np.zeros_like(q),
        "tip": np.zeros((BLOCK, 3)),
        "points": np.zeros((BLOCK, 4, 3)),
        "gap": gap,
    }


def raw(sample0, n=64, channels=6):
    number = sample0 + np.arange(n, dtype=float)
    a = number[:, None] + np.arange(channels) / 10
    t0_ns = START_NS + round(sample0 / 32000 * 1e9)
    return {"sample0": sample0, "t0_ns": t0_ns, "dt_s": 1 / 32000, "n": n, "a": a}


def phase(trial, state, frame, role):
    return {"trial": trial, "t_ns": START_NS + frame * 1_000_000, "state": state, "role": role}


def record(path, messages, first_ns=0):
    with RecordingWriter(path, "schema = 1", "", clock=lambda: 0.0) as writer:
        for number, (topic, fields) in enumerate(messages, first_ns):
            writer.write(topic, encode(topic, fields)[1], number)
    return path


def recorded_motions(folder, method, slide=False):
    """Record two motions in which all joints move at 1 rad/s, and all sensors at 1 m/s if they are to slide."""
    blocks = [(FRAMES, {**frames(k), "method": method}) for k in range(0, 1000, BLOCK)]
    for _, fields in blocks if slide else []:
        fields["points"] = np.repeat(fields["q"][:, :1], 12, axis=1).reshape(BLOCK, 4, 3)
    blocks.insert(12, (TRIAL, phase(1, "begin", 100, "learn")))
    blocks.insert(45, (TRIAL, phase(1, "end", 400, "learn")))
    blocks.insert(60, (TRIAL, phase(2, "begin", 550, "evaluate")))
    return record(folder / "day.mcap", blocks)


@pytest.fixture
def two_motions(tmp_path):
    return recorded_motions(tmp_path, "integrate")


def test_motions_are_cut_out_as_announced(two_motions):
    first, second = read_frames([two_motions], 2)
    assert (first.name, first.role, len(first.t)) == ("day/1", "learn", 301)
    assert (second.name, second.role, len(second.t)) == ("day/2", "evaluate", 450)
    assert np.isclose(first.columns["q"][0, 0], 0.100)
    assert first.columns["points"].shape == (301, 4, 3)


def test_dead_reckoning_loses_its_drift(two_motions):
    """Every joint moves at 1 rad/s until the rest at the end: all of that is drift, and is taken out."""
    first, _ = read_frames([two_motions], 2)
    assert np.isclose(np.diff(first.columns["q"][:-1, 0])[-1], 0.0, atol=1e-5)
    (note,) = first.notes
    assert note.text == "drift taken out by the rest at the end of each motion (q, dq, ddq, points)"


def test_of_a_filter_only_the_points_are_dead_reckoned(tmp_path):
    first, _ = read_frames([recorded_motions(tmp_path, "filter", slide=True)], 2)
    assert np.allclose(first.columns["q"][:, 0], 1e-3 * (100 + np.arange(301)))
    assert np.array_equal(first.columns["dq"], np.ones((301, 2)))
    speed = np.diff(first.columns["points"][:, 0, 0]) / DT_S
    assert speed[0] == pytest.approx(1.0, abs=0.01) and speed[-2] == pytest.approx(0.0, abs=0.01)
    (note,) = first.notes
    assert note.text == "drift taken out by the rest at the end of each motion (points)"


def test_trials_of_one_role_are_taken_as_they_are(tmp_path):
    (trial,) = load_trials([recorded_motions(tmp_path, "filter")], 2, role="evaluate")
    assert trial.role == "evaluate"
    assert trial.dt_s == DT_S
    assert np.array_equal(trial.q[:, 0], 1e-3 * (550 + np.arange(450)))
    assert np.array_equal(trial.dq, np.ones((450, 2)))
    assert trial.points.shape == (450, 4, 3)
    (note,) = trial.notes
    assert note.text == "the recording ends before the motion does: its drift is left in it (points)"


def test_a_motion_that_is_broken_off_was_not_at_rest_there(tmp_path):
    _, second = read_frames([recorded_motions(tmp_path, "integrate")], 2)
    assert np.allclose(np.diff(second.columns["q"][:, 0]) / DT_S, 1.0)
    assert np.array_equal(second.columns["dq"], np.ones((450, 2)))


@pytest.fixture
def in_two_files(tmp_path):
    """Record a motion from frame 100 to 400 in two files; the second repeats two blocks of the first."""
    run = {"run": "a", "seq": 0}
    blocks = [(FRAMES, frames(k) | run) for k in range(0, 500, BLOCK)]
    samples = [(RAW, raw(k) | run) for k in range(0, 640, 64)]
    begin, end = ((TRIAL, phase(1, *event, "learn") | run) for event in (("begin", 100), ("end", 400)))
    first = record(tmp_path / "run.mcap", [*samples[:5], *blocks[:20], begin])
    second = record(tmp_path / "run-002.mcap", [begin, *samples[3:], *blocks[18:], end], 18)
    return [second, first]  # as a folder has them, by name


def test_a_motion_goes_on_in_the_next_file(in_two_files, tmp_path):
    other = record(tmp_path / "other.mcap", [(FRAMES, frames(0) | {"run": "b"})])
    together, alone = by_run([*in_two_files, other])
    assert together == tuple(reversed(in_two_files)) and alone == (other,)
    (motion,) = read_frames(together, 2)
    assert (motion.name, motion.first_row) == ("run/1", 100)
    np.testing.assert_allclose(motion.t, 0.1 + DT_S * np.arange(301), atol=1e-12)
    (trial,) = load_trials(in_two_files, 2)
    assert len(trial.q) == 301


def test_samples_go_on_in_the_next_file(in_two_files):
    (run,) = load_raw(in_two_files, ("s1", "s2"), 2)
    assert run.a[:, 0].tolist() == list(range(640)) and not run.gaps


def test_a_recording_without_announcements_is_one_motion(tmp_path):
    path = record(tmp_path / "run.mcap", [(FRAMES, frames(k)) for k in range(0, 100, BLOCK)])
    (motion,) = read_frames([path], 2)
    assert motion.name == "run" and motion.role is None and len(motion.t) == 100


def test_no_trial_of_a_role(tmp_path):
    path = announced(tmp_path, phase(1, "begin", 50, "evaluate"), phase(1, "end", 100, "evaluate"))
    with pytest.raises(DataError, match="no trial with role 'learn'"):
        load_trials([path], 2, role="learn")


def test_lost_samples_are_said_and_long_gaps_part_a_motion(tmp_path):
    messages = [(FRAMES, frames(k)) for k in range(0, 100, BLOCK)]
    messages += [(FRAMES, frames(500, gap=True)), (FRAMES, frames(510))]
    trials = load_trials([record(tmp_path / "run.mcap", messages)], 2)
    assert [trial.name for trial in trials] == ["run#1", "run#2"]
    assert "1 block(s) of frames after lost samples" in [note.text for note in trials[0].notes]


def test_a_recording_cut_short_is_read_to_the_cut(two_motions, tmp_path):
    cut = tmp_path / "cut.mcap"
    with RecordingWriter(cut, "", "", clock=iter(range(10**6)).__next__) as writer:
        for number, k in enumerate(range(0, 2000, BLOCK)):
            writer.write(FRAMES, encode(FRAMES, frames(k))[1], number)
    content = cut.read_bytes()
    cut.write_bytes(content[: len(content) // 2])
    (motion,) = read_frames([cut], 2)
    assert 100 < len(motion.t) < 2000
    assert "cut" in motion.notes[0].text


def test_raw_blocks_are_a_run_with_its_gaps(tmp_path):
    path = record(tmp_path / "run.mcap", [(RAW, raw(k)) for k in (0, 64, 128, 320, 384)])
    (run,) = load_raw([path], ("s1", "s2"), 2)
    assert run.a.shape == (320, 6)
    assert np.isclose(run.rate_hz, 32000)
    assert [(gap.row, gap.samples) for gap in run.gaps] == [(192, 128)]
    assert run.a[192, 0] == 320.0


def test_recordings_of_something_else(tmp_path):
    path = record(tmp_path / "run.mcap", [(FRAMES, frames(0)), (RAW, raw(0))])
    with pytest.raises(DataError, match="expected 3 as the arm has"):
        read_frames([path], 3)
    with pytest.raises(DataError, match="expected 12"):
        load_raw([path], ("s1", "s2", "s3", "s4"), 2)
    empty = record(tmp_path / "empty.mcap", [])
    with pytest.raises(DataError, match="no limb/frames"):
        read_frames([empty], 2)
    with pytest.raises(DataError, match="no limb/raw"):
        load_raw([empty], ("s1",), 2)
    odd = record(tmp_path / "odd.mcap", [(FRAMES, frames(0) | {"q": "none"})])
    with pytest.raises(DataError, match="q of a block is str"):
        read_frames([odd], 2)
    timeless = record(tmp_path / "timeless.mcap", [(FRAMES, frames(0) | {"t0_ns": None})])
    with pytest.raises(DataError, match="t0_ns of a block is None"):
        read_frames([timeless], 2)


def test_time_is_counted_from_the_first_frame(two_motions):
    first, second = read_frames([two_motions], 2)
    np.testing.assert_allclose(first.t, 0.1 + 1e-3 * np.arange(301), atol=1e-12)
    np.testing.assert_allclose(second.t, 0.55 + 1e-3 * np.arange(450), atol=1e-12)
    assert (first.first_row, second.first_row) == (100, 550)


def announced(folder, *events, n=300):
    blocks = [(FRAMES, {**frames(k), "method": "filter"}) for k in range(0, n, BLOCK)]
    return record(folder / "day.mcap", [*blocks, *((TRIAL, event) for event in events)])


@pytest.mark.parametrize(
    ("events", "found"),
    [
        ([(1, "begin", 50), (1, "end", 100)], [("day/1", 50, 51)]),
        ([(1, "begin", 50), (2, "begin", 120), (2, "end", 150)], [("day/1", 50, 71), ("day/2", 120, 31)]),
        ([(1, "end", 50), (2, "begin", 120)], [("day/2", 120, 180)]),
        ([(1, "begin", 500), (1, "end", 600), (2, "begin", 10), (2, "end", 12)], [("day/2", 10, 3)]),
        ([(1, "end", 50)], [("day", 0, 300)]),
    ],
)
def test_a_motion_lasts_until_anything_else_is_announced(tmp_path, events, found):
    path = announced(tmp_path, *(phase(trial, state, frame, "learn") for trial, state, frame in events))
    assert [(one.name, one.first_row, len(one.t)) for one in read_frames([path], 2)] == found


def test_a_role_may_be_missing(tmp_path):
    events = [{**phase(1, "begin", 50, None)}, phase(1, "end", 100, None)]
    (motion,) = read_frames([announced(tmp_path, *events)], 2)
    assert motion.role is None


def test_a_claim_is_read_where_every_block_has_one(tmp_path):
    blocks = [frames(k) | {"q_std": np.full((BLOCK, 2), 0.1 + k)} for k in (0, 10, 20)]
    path = record(tmp_path / "run.mcap", [(FRAMES, block) for block in blocks])
    (motion,) = read_frames([path], 2)
    assert motion.columns["q_std"][::10, 0].tolist() == [0.1, 10.1, 20.1]
    del blocks[1]["q_std"]
    (motion,) = read_frames([record(tmp_path / "less.mcap", [(FRAMES, block) for block in blocks])], 2)
    assert set(motion.columns) == {"q", "dq", "ddq", "points"}


def test_each_block_after_lost_samples_is_counted(tmp_path):
    gaps = [(FRAMES, frames(k, gap=k in (20, 50))) for k in range(0, 100, BLOCK)]
    (motion,) = read_frames([record(tmp_path / "run.mcap", gaps)], 2)
    assert [note.text for note in motion.notes] == ["2 block(s) of frames after lost samples"]
    assert motion.notes[0].kind == "lost"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dt_s": None}, "dt_s of a block is None, expected a number"),
        ({"n": 9}, "q of a block is ndarray, expected one row a sample"),
        ({"n": 10.5}, "n of a block is 10.5, expected a whole number"),
        ({"t0_ns": "now"}, "t0_ns of a block is 'now', expected a whole number"),
    ],
)
def test_a_block_that_is_none_is_said(tmp_path, change, words):
    path = record(tmp_path / "run.mcap", [(FRAMES, frames(0)), (FRAMES, frames(10) | change)])
    with pytest.raises(DataError, match=words):
        read_frames([path], 2)


def test_raw_samples_are_stamped_from_the_first_on(tmp_path):
    t, a = read_raw_blocks([record(tmp_path / "run.mcap", [(RAW, raw(k)) for k in (640, 704, 832)])], 6)
    np.testing.assert_allclose(t, np.concatenate([np.arange(128), 192 + np.arange(64)]) / 32000, atol=1e-9)
    assert a[:, 0].tolist() == [*range(640, 768), *range(832, 896)]


def test_frames_at_which_the_filter_knew_no_more_do_not_count(tmp_path):
    blocks = [(FRAMES, {**frames(k, gap=k >= 500), "method": "filter"}) for k in range(0, 1000, BLOCK)]
    for _, fields in blocks:
        fields["q_std"] = np.full((BLOCK, 2), 0.5 if fields["gap"] else 1e-3)
    path = record(tmp_path / "run.mcap", blocks)
    (trial,) = load_trials([path], 2)
    assert trial.counted[:500].all() and not trial.counted[500:].any()
    assert "uncertain" in {note.kind for note in trial.notes}
