"""Segments over trials."""

import numpy as np

from fitter.functional.segment_motion import segment_motion
from tests.fitter.functional.test_rigid_fit import SHAPE, moved

NAMES = ("A", "B", "C", "D", "E")


def test_a_point_is_placed_in_the_segment_by_its_median_over_trials():
    rng = np.random.default_rng(1)
    trials = [moved(rng, n) for n in (40, 60)]
    segment = segment_motion("thigh_left", NAMES, [x for _, _, x in trials])
    point = np.array([0.1, -0.3, 0.05])
    seen = [R @ point + p for R, p, _ in trials]
    seen[0][:10] = np.nan
    seen[1][:5] += 1.0  # a marker that was something else for some frames
    distances = np.linalg.norm(segment.template.points_m - segment.place(seen), axis=1)
    assert np.allclose(distances, np.linalg.norm(SHAPE - point, axis=1), atol=1e-5)


def test_a_point_that_was_never_seen_has_no_place():
    _, _, x = moved(np.random.default_rng(2), 20)
    segment = segment_motion("thigh_left", NAMES, [x])
    assert np.isnan(segment.place([np.full((20, 3), np.nan)])).all()


def test_all_trials_share_one_template():
    trials = [moved(np.random.default_rng(seed), 30)[2] for seed in range(3)]
    segment = segment_motion("thigh_left", NAMES, trials)
    assert [len(poses.p) for poses in segment.trials] == [30, 30, 30]
    assert len(segment.whole.p) == 90
    assert np.all(segment.whole.rms_m < 1e-5)


def test_frames_far_off_their_shape_are_left_out_and_told():
    trials = [moved(np.random.default_rng(seed), 100, noise_m=0.001)[2] for seed in range(2)]
    trials[1][40:50, [0, 1]] = trials[1][40:50, [1, 0]]
    segment = segment_motion("thigh_left", NAMES, trials)
    assert np.array_equal(np.flatnonzero(~segment.trials[1].valid), np.arange(40, 50))
    assert segment.trials[0].valid.all()
    (note,) = segment.notes
    assert note.kind == "doubted_pose"
    assert "in 10 of 200 frames, frame 41 of trial 2 the first" in note.text


def test_skin_that_wobbles_is_not_doubted():
    _, _, x = moved(np.random.default_rng(3), 2000, noise_m=0.012)
    assert segment_motion("thigh_left", NAMES, [x]).notes == ()


def test_a_marker_without_a_place_is_told():
    _, _, x = moved(np.random.default_rng(4), 50)
    x[:, 1] = np.nan
    (note,) = segment_motion("thigh_left", NAMES, [x]).notes
    assert (note.kind, note.columns) == ("unplaced_marker", ("B",))
