"""Readings of a whole run, tracked."""

from dataclasses import replace

import numpy as np
import pytest

from arm.bench import Bench, Sensors, draw_sensor_errors, motions
from arm.counts import COUNT_M_S2
from arm.gyroscope import angular_velocity
from arm.kinematics import tip_position
from fitter.data.gaps import Gap
from fitter.data.raw import RawRun
from fitter.sensing.track import beginning, parted, track_run, trials_of, true_angles
from fitter.sensing.verdict import Verdict
from limbcal.errors import ConfigError
from tracking.model.frames import Phase


@pytest.fixture(scope="module")
def run(short_run):
    truth = short_run.truth
    return RawRun("day", 4000.0, short_run.t + 100.0, short_run.a, q=truth["q"], ref=truth["ref"])


@pytest.fixture(scope="module")
def start(run):
    """Return its first seven seconds: one motion, and the beginning of the next."""
    n = 30000
    return replace(run, t=run.t[:n], a=run.a[:n], q=run.q[:n], ref=run.ref[:n])


@pytest.fixture(scope="module")
def tracked(run, short_run):
    return track_run(run, short_run.arm, np.zeros(2), 1000.0, "integrate")


def test_the_motion_is_the_benchs_on_the_clock_of_the_readings(tracked, run, short_run):
    columns = tracked.columns
    assert set(columns) == {"t", "q", "dq", "ddq", "tip", "ref", "trial"}
    assert tracked.frames == len(columns["t"]) == pytest.approx(len(run.t) / 4, abs=4)
    assert columns["t"][0] == pytest.approx(run.t[0], abs=2e-3)
    assert np.allclose(np.diff(columns["t"]), 1e-3)
    assert np.rad2deg(np.abs(columns["q"] - truth_at(columns["t"], run.t, run.q))).max() < 1.0
    assert np.abs(columns["dq"] - truth_at(columns["t"], run.t, short_run.truth["dq"])).max() < 0.02
    assert np.abs(columns["tip"] - tip_position(short_run.arm, columns["q"])).max() < 0.01


def truth_at(t, clock, values):
    return np.column_stack([np.interp(t, clock, column) for column in values.T])


def test_errors_are_those_against_the_true_angles(tracked, run):
    assert tracked.error_deg.shape == (tracked.frames, 2)
    expected = np.rad2deg(np.abs(tracked.columns["q"] - truth_at(tracked.columns["t"], run.t, run.q)))
    assert np.allclose(tracked.error_deg, expected, rtol=0, atol=1e-3)


def test_nothing_is_scored_where_truth_is_lost() -> None:
    """Over a hole of a quarter of a period a straight line would be off by 0.2."""
    t = 0.01 * np.arange(400)
    there = np.r_[:157, 210:400]
    angle = np.sin(2.0 * np.pi * t)[:, None]
    run = RawRun("torn", 100.0, t[there], np.zeros((len(there), 3)), (Gap(157, 53),), q=angle[there])
    at = t[:-1] + 0.004
    true = true_angles(run, at)
    assert true is not None
    assert np.array_equal(np.isnan(true[:, 0]), (at > 1.565) & (at < 2.095))
    assert np.nanmax(np.abs(true[:, 0] - np.sin(2.0 * np.pi * at))) < 1e-5
    assert true_angles(replace(run, q=None), at) is None


@pytest.mark.parametrize(("method", "said"), [("smooth", "what follows"), ("integrate", "--method smooth")])
def test_a_recording_that_begins_in_motion_is_noted(start, short_run, method, said):
    fast = slice(int(np.argmax(np.abs(short_run.truth["dq"][:8000]).max(axis=1))), None)
    cut = replace(start, t=start.t[fast], a=start.a[fast], q=start.q[fast], ref=None)
    notes = track_run(cut, short_run.arm, cut.q[0], 250.0, method).notes
    (note,) = (note for note in notes if note.kind != "parted")
    assert note.kind == "moving" and said in note.text and note.from_s == cut.t[0]
    assert {note.kind for note in track_run(start, short_run.arm, np.zeros(2), 250.0, "integrate").notes} == {
        "parted"
    }


def test_a_recording_that_rests_part_is_noted_unless_it_has_labels(start, short_run):
    (note,) = track_run(start, short_run.arm, np.zeros(2), 250.0, "integrate").notes
    assert note.kind == "parted" and "trials parted by rests: 2 motions" in note.text
    labels = short_run.trial[: len(start.t)]
    assert track_run(replace(start, trial=labels), short_run.arm, np.zeros(2), 250.0, "integrate").notes == ()
    assert parted([Phase("begin", 0, 1), Phase("end", 5, 1)]) == ()


def test_targets_are_the_ones_held_at_each_frame(tracked, run):
    t, ref = tracked.columns["t"], tracked.columns["ref"]
    assert np.array_equal(ref[t < 100.49], np.zeros((np.count_nonzero(t < 100.49), 2)))
    assert np.array_equal(ref[-1], run.ref[-1])
    assert {tuple(row) for row in ref} == {tuple(row) for row in run.ref}


def test_motions_are_told_apart_by_the_rests(tracked):
    trial, t = tracked.columns["trial"], tracked.columns["t"]
    assert np.array_equal(np.unique(trial), [1, 2, 3])
    assert np.all(np.diff(trial) >= 0)
    starts = [t[trial == k][0] for k in (2, 3)]
    assert 102.0 < starts[0] < 107.25 and 107.25 < starts[1] < 114.0  # after one rests, before the next begins


def test_the_readings_own_labels_win(start, short_run):
    labels = np.array([f"no. {k}" for k in short_run.trial[: len(start.t)]])
    tracked = track_run(replace(start, trial=labels), short_run.arm, np.zeros(2), 1000.0, "integrate")
    assert sorted(set(tracked.columns["trial"])) == ["no. 1", "no. 2"]


def test_without_truth_target_or_tip_there_is_less_to_say(start, short_run):
    bare = replace(start, q=None, ref=None)
    tracked = track_run(bare, replace(short_run.arm, tip=None), np.zeros(2), 250.0, "integrate")
    assert set(tracked.columns) == {"t", "q", "dq", "ddq", "trial"}
    assert tracked.error_deg is None and tracked.within_3_std is None
    assert np.allclose(np.diff(tracked.columns["t"]), 4e-3)


def test_only_before_the_first_motion_as_the_paper_does(start, short_run, tracked):
    once = track_run(start, short_run.arm, np.zeros(2), 1000.0, "integrate", "first-rest")
    first, later = slice(0, 3000), slice(6000, once.frames - 1)
    assert np.allclose(once.columns["q"][first], tracked.columns["q"][first], atol=1e-3)
    assert not np.allclose(once.columns["q"][later], tracked.columns["q"][later], atol=1e-9)


def test_no_more_frames_than_readings(run, short_run):
    slow = replace(run, rate_hz=200.0, t=run.t[::20], a=run.a[::20], q=None, ref=None)
    tracked = track_run(slow, short_run.arm, np.zeros(2), 1000.0, "integrate")
    assert np.allclose(np.diff(tracked.columns["t"]), 5e-3)


def test_a_gap_is_bridged(start, short_run):
    kept = np.r_[0:12000, 12080 : len(start.t)]  # 20 ms, while the arm moves
    torn = RawRun("day", 4000.0, start.t[kept], start.a[kept], gaps=(Gap(12000, 80),), q=start.q[kept])
    tracked = track_run(torn, short_run.arm, np.zeros(2), 1000.0, "integrate")
    assert np.all(np.diff(tracked.columns["t"]) > 0.0)
    assert np.diff(tracked.columns["t"]).max() == pytest.approx(0.02, abs=3e-3)
    truth = truth_at(tracked.columns["t"], start.t, start.q)
    assert np.rad2deg(np.abs(tracked.columns["q"] - truth)).max() < 5.0


@pytest.fixture(scope="module")
def noisy(short_run):
    """Return two motions of the bench with all its noise, of which 40 ms are lost while the arm moves."""
    arm, rng = short_run.arm, np.random.default_rng(5)
    sensors = Sensors(arm, draw_sensor_errors(arm, rng), 4000.0, rng)
    moved = list(motions(arm, Bench(rate_hz=4000.0, learning=2, evaluating=0), seed=5))
    a = COUNT_M_S2 * np.concatenate([sensors.counts(motion) for motion in moved])
    q = np.concatenate([motion.q for motion in moved])
    t = 100.0 + np.arange(len(a)) / 4000.0
    kept = np.r_[0:11000, 11160 : len(a)]
    return RawRun("noisy", 4000.0, t[kept], a[kept], gaps=(Gap(11000, 160),), q=q[kept])


@pytest.fixture(scope="module", params=["filter", "smooth"])
def claimed(request, noisy, short_run):
    """Return the method and what it makes of them; nobody says where the arm rests at first."""
    return request.param, track_run(noisy, short_run.arm, None, 1000.0, request.param)


def test_angles_stay_within_what_is_claimed_of_them(claimed, noisy):
    method, found = claimed
    columns = found.columns
    assert set(columns) == {"t", "q", "dq", "ddq", "q_std", "gap", "tip", "trial"}
    assert columns["q_std"].shape == columns["q"].shape and np.all(columns["q_std"] > 0.0)
    assert columns["t"][0] == pytest.approx(100.0, abs=2e-3)
    assert np.allclose(np.diff(columns["t"]), 1e-3)  # what was lost is bridged
    scored = columns["gap"] == 0
    error = np.abs(columns["q"] - truth_at(columns["t"], noisy.t, noisy.q))[scored]
    assert np.allclose(np.deg2rad(found.error_deg), error, rtol=0, atol=1e-5)
    assert np.mean(found.within_3_std == (error <= 3.0 * columns["q_std"][scored])) > 0.999
    if method == "smooth":
        assert found.error_deg.max() < 3.0
        assert found.within_3_std.mean() > 0.9
    assert np.array_equal(np.unique(columns["trial"]), [1, 2])


def test_frames_that_fell_due_among_lost_samples_are_marked(claimed):
    columns = claimed[1].columns
    marked = columns["t"][columns["gap"] == 1]
    assert np.array_equal(np.unique(columns["gap"]), [0, 1])
    assert marked[0] == pytest.approx(102.75, abs=1e-3) and marked[-1] == pytest.approx(102.79, abs=1e-3)
    assert len(marked) == 40


def test_the_tip_is_still_measured_and_does_not_drift(claimed, short_run):
    columns = claimed[1].columns
    unbridged = columns["t"] < 102.7
    computed = tip_position(short_run.arm, columns["q"])
    assert np.abs(columns["tip"] - computed)[unbridged].max() < 0.02
    assert not np.allclose(columns["tip"], computed, atol=1e-6)


def test_a_tracker_says_what_it_thinks_of_itself(claimed):
    method, found = claimed
    verdict = found.verdict
    assert verdict.wrong is False and 0.0 <= verdict.doubted < 0.01
    if method == "filter":
        assert 0.1 < verdict.innovation < 1.5
        assert verdict.passes is None and verdict.converged is None
    else:
        assert verdict.innovation is None
        assert verdict.passes > 1 and verdict.converged is True


def test_the_papers_method_claims_nothing(tracked):
    assert tracked.verdict == Verdict()
    assert tracked.within_3_std is None and "q_std" not in tracked.columns


@pytest.fixture(scope="module")
def moved(short_run):
    """Return the arm with its last sensor centimetres beside its place."""
    *others, last = short_run.arm.sensors
    return replace(short_run.arm, sensors=(*others, replace(last, position_m=(0.20, 0.05, 0.0))))


def test_a_filter_notices_a_sensor_that_sits_elsewhere(noisy, moved):
    verdict = track_run(noisy, moved, np.zeros(2), 250.0, "filter").verdict
    assert verdict.wrong is True and verdict.discrepancy_m_s2 > 0.0


@pytest.mark.parametrize("rate_hz", [250.0, 500.0])
def test_a_smoother_finds_that_a_sensor_sits_elsewhere(noisy, moved, short_run, rate_hz):
    by = np.linalg.norm(np.subtract(moved.sensors[-1].position_m, short_run.arm.sensors[-1].position_m))
    found = track_run(noisy, moved, np.zeros(2), rate_hz, "smooth")
    assert found.verdict.wrong is True and found.verdict.place_off_m == pytest.approx(by, rel=0.1)
    assert found.within_3_std.mean() > 0.9


@pytest.mark.parametrize("method", ["filter", "smooth"])
def test_where_the_arm_rests_can_be_said(start, short_run, method):
    found = track_run(start, short_run.arm, np.array([0.5, -0.25]), 250.0, method)
    assert np.allclose(found.columns["q"][0], [0.5, -0.25], atol=0.02)


def test_sliding_joints_are_off_by_millimetres(start, short_run):
    first, second = short_run.arm.joints
    sliding = replace(short_run.arm, joints=(first, replace(second, type="prismatic")))
    tracked = track_run(start, sliding, np.zeros(2), 1000.0, "integrate")
    error = np.abs(tracked.columns["q"] - truth_at(tracked.columns["t"], start.t, start.q))
    assert np.allclose(tracked.error_deg, error * [180.0 / np.pi, 1e3], rtol=0, atol=1e-3)


def test_sensors_that_cannot_tell_the_angles(run, short_run):
    blind = replace(short_run.arm, sensors=short_run.arm.sensors[:2])
    with pytest.raises(ConfigError):
        track_run(replace(run, a=run.a[:, :6]), blind, np.zeros(2), 1000.0, "integrate")


@pytest.mark.parametrize(
    ("phases", "expected"),
    [
        ([], [1, 1, 1, 1, 1, 1]),
        ([("begin", 1)], [1, 1, 1, 1, 1, 1]),
        ([("begin", 1), ("end", 2)], [1, 1, 1, 1, 1, 1]),
        ([("begin", 1), ("end", 2), ("begin", 4)], [1, 1, 2, 2, 2, 2]),
        ([("begin", 1), ("end", 2), ("begin", 3), ("end", 4)], [1, 1, 2, 2, 2, 2]),
        ([("begin", 0), ("end", 1), ("begin", 1), ("end", 3), ("begin", 4), ("end", 5)], [1, 2, 2, 3, 3, 3]),
    ],
)
def test_every_frame_belongs_to_a_motion(phases, expected):
    announced = [Phase(kind, second * 1_000_000_000, 0) for kind, second in phases]
    assert trials_of(np.arange(6.0), announced).tolist() == expected


@pytest.fixture(scope="module")
def sensed(start, short_run):
    """Return the same with gyroscopes on the sensors s2 and s4 of its arm."""
    arm, rng = short_run.arm.with_gyroscopes(("s2", "s4")), np.random.default_rng(0)
    dq = short_run.truth["dq"][: len(start.t)]
    w = angular_velocity(arm, start.q, dq).reshape(len(dq), -1)
    w = w + 0.01 * rng.standard_normal(w.shape[1]) + 0.01 * rng.standard_normal(w.shape)
    return replace(start, gyros=("s2", "s4"), w=w)


@pytest.mark.parametrize("method", ["filter", "smooth"])
def test_gyroscopes_make_angles_better(method, sensed, short_run):
    """The level arm's first angle is shown by nothing but integrals: of one of them once, and not twice."""
    found = {
        run.gyros: track_run(run, short_run.arm, np.zeros(2), 1000.0, method)
        for run in (sensed.with_gyros(()), sensed)
    }
    alone, beside = (one.error_deg.mean(axis=0) for one in found.values())
    assert (beside < alone).all()
    assert found[sensed.gyros].within_3_std.mean() > 0.99


def test_dead_reckoning_leaves_gyroscopes_aside(sensed, start, short_run):
    found = [track_run(run, short_run.arm, np.zeros(2), 1000.0, "integrate") for run in (sensed, start)]
    np.testing.assert_array_equal(found[0].columns["q"], found[1].columns["q"])


def test_a_recording_begins_for_the_note_as_it_does_for_the_smoother() -> None:
    """A person who stands sways by more than the noise of half a second, and by less than that of all."""
    t = np.arange(2000) / 100.0
    a = np.random.default_rng(0).normal(0.0, 0.03, (t.size, 3))
    a[:50] *= 0.3
    a[12:25] += 0.03
    run = RawRun("stands", 100.0, t, a + [0.0, 0.0, 9.8])
    assert run.readings(100.0).begins_steadily
    assert beginning(run, 100.0, "smooth") == ()
    assert [note.kind for note in beginning(run, 100.0, "filter")] == ["moving"]
