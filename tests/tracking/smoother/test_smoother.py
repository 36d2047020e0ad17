"""The smoother along bench motions: better than the filter, and as good as it says."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench
from tracking.smoother.smoother import Smoother

RATE_HZ = 250.0
#: Samples lost in the middle of the first motion.
GAP = slice(4000, 6400)
#: In the tail of a motion, and in its fastest part.
LONG_GAP, FAST_GAP = slice(3200, 8000), slice(2400, 8000)


def truth_of(recording, readings):
    at = readings.t0_s + readings.dt_s * np.arange(len(readings.values))
    columns = [
        np.interp(at, recording.t, getattr(recording, name)[:, j])
        for j in range(recording.arm.n_joint)
        for name in ("q", "dq", "ddq")
    ]
    return np.column_stack(columns)


def smoothed(recording, readings, q0, **options):
    found = Smoother(recording.arm, q0, True).smooth(readings, **options)
    return found, np.abs(found.states[:, :6] - truth_of(recording, readings))


@pytest.fixture(scope="module")
def level(level_bench, decimated):
    return smoothed(level_bench, decimated(level_bench, RATE_HZ), level_bench.q[0])


@pytest.fixture(scope="module")
def upright(upright_bench, decimated):
    return smoothed(upright_bench, decimated(upright_bench, RATE_HZ), upright_bench.q[0])


def test_it_is_better_than_the_filter(level_bench, upright_bench, level, upright, followed):
    """On the same frames of the same readings."""
    for bench, (_, off) in ((level_bench, level), (upright_bench, upright)):
        filtered = followed(bench, bench.q[0], rate_hz=RATE_HZ)[0].error_deg().mean()
        assert np.rad2deg(off[:, ::3]).mean() < filtered


def test_it_converges(level, upright):
    for found, _ in (level, upright):
        assert found.converged and 1 < found.passes < 15
        assert found.doubted == 0.0


def test_errors_are_within_what_it_says(level, upright):
    """95 % within three standard deviations: of angles, speeds and, but for where they jump, accelerations."""
    for found, off in (level, upright):
        assert found.variance.shape == off.shape and (found.variance > 0.0).all()
        within = off < 3 * np.sqrt(found.variance)
        assert within[:, ::3].mean() > 0.95
        assert within[:, 1::3].mean() > 0.95


@pytest.mark.parametrize("bench", ["level_bench", "upright_bench"])
def test_a_recording_may_begin_in_the_middle_of_a_motion(bench, decimated, request):
    whole = request.getfixturevalue(bench)
    begin = int(np.argmax(np.abs(whole.dq).max(axis=1)))  # as fast as it ever is
    parts = {name: getattr(whole, name)[begin : begin + 16000] for name in ("readings", "q", "dq", "ddq")}
    cut = replace(whole, t=whole.t[: len(parts["q"])], **parts)
    found, off = smoothed(cut, decimated(cut, RATE_HZ), cut.q[0])
    assert found.converged and found.doubted < 0.01
    assert (off[:, ::3] < 3 * np.sqrt(found.variance[:, ::3])).mean() > 0.95
    assert np.rad2deg(off[:, ::3]).max() < 2.0


def test_claims_are_not_idle(upright):
    """A claim ten times too large would be kept too; these are of the size of the errors."""
    found, off = upright
    assert np.sqrt(np.mean(found.variance[:, ::3])) < 5 * np.sqrt(np.mean(off[:, ::3] ** 2))


def test_it_rests_where_the_arm_does(level_bench, level):
    found, off = level
    speed = np.abs(level_bench.dq[8::16]).max(axis=1)
    assert found.resting[:120].all() and not found.resting[speed > 0.2].any()
    assert np.mean(speed[found.still] < 0.02) > 0.98  # a motion that begins shows once a cell is full
    assert off[found.still][:, 1::3].max() < 0.06  # of 0.15 rad/s that it has by then


def test_passes_are_told(upright_bench, decimated):
    told = []
    found = Smoother(upright_bench.arm, upright_bench.q[0], True).smooth(
        decimated(upright_bench, RATE_HZ), fine=False, progress=told.append
    )
    assert told == list(range(1, found.passes + 1))


def test_coarse_passes_know_as_much_of_the_constants(upright_bench, upright, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    coarse = Smoother(upright_bench.arm, upright_bench.q[0], True).smooth(readings, fine=False)
    fine, _ = upright
    assert len(coarse.states) == -(-len(fine.states) // 4)
    std = np.sqrt(np.diag(fine.covariance)[6:])
    assert (np.abs(coarse.final - fine.final)[6:] < 3 * std).all()
    np.testing.assert_allclose(np.sqrt(np.diag(coarse.covariance)[6:]), std, rtol=0.2)


def test_what_an_earlier_recording_showed_is_known(upright_bench, upright, decimated):
    """Offsets and lengths go on from there, and are known better at the end."""
    readings, (before, _) = decimated(upright_bench, RATE_HZ), upright
    after = Smoother(upright_bench.arm, upright_bench.q[0], True).smooth(readings, known=before)
    np.testing.assert_array_equal(after.before[6:, 6:], before.covariance[6:, 6:])
    std = [np.sqrt(np.diag(found.covariance)[6:-1]) for found in (before, after)]  # a shift d shows in no plane
    assert (std[1] < 1.01 * std[0]).all() and std[1].mean() < 0.9 * std[0].mean()


def test_a_gap_is_bridged_from_both_sides(upright_bench, upright, decimated):
    """0.6 s in mid-motion: off by no more than said, and by less than without what comes after it."""
    readings = decimated(upright_bench, RATE_HZ, GAP)
    missing = ~readings.present
    assert missing.sum() == 150
    found, off = smoothed(upright_bench, readings, upright_bench.q[0])
    std = np.sqrt(np.maximum(found.variance, 0.0))
    assert found.converged and np.isfinite(found.states).all()
    assert (off[:, ::3][missing][:-10] < 4 * std[:, ::3][missing][:-10]).all()
    middle = np.flatnonzero(missing)[75]
    assert (std[middle, ::3] > std[missing][0, ::3]).all() and (std[middle, ::3] > std[missing][-1, ::3]).all()
    assert (std[missing] > np.sqrt(upright[0].variance)[missing]).mean() > 0.99
    assert not found.still[missing].any()


@pytest.mark.parametrize("seed", range(8))
def test_after_a_long_gap_no_more_is_claimed_than_is_known(dd_arm, recorded, decimated, seed):
    """1.2 s within a motion that gravity does not show: noise in the slopes seemed to show the elbow's angle."""
    bench = recorded(dd_arm, Bench(4000.0, learning=1, evaluating=0), seed, 1.0)
    readings = decimated(bench, RATE_HZ, LONG_GAP)
    found = Smoother(dd_arm, bench.q[0], True).smooth(readings)
    elbow = found.states[:, 3] - truth_of(bench, readings)[:, 3]
    after = np.flatnonzero(~readings.present)[-1] + 5
    assert (np.abs(elbow) < 3.0 * np.sqrt(found.variance[:, 3]))[after:].all()


@pytest.mark.parametrize("seed", [0, 3, 11])
def test_after_a_gap_a_joint_has_not_gone_round(recorded, decimated, seed):
    """Seen by gravity again, it is where it is, and not a whole turn further; the base turns unseen."""
    arm = load_arm("spatial-arm")
    bench = recorded(arm, Bench(4000.0, trial_s=4.0, learning=1, evaluating=0), seed, 1.0)
    readings = decimated(bench, RATE_HZ, FAST_GAP)
    found = Smoother(arm, bench.q[0], True).smooth(readings)
    off = np.abs(found.states[:, 3:9:3] - truth_of(bench, readings)[:, 3:9:3])
    assert off[np.flatnonzero(~readings.present)[-1] + 5 :].max() < 0.05


def test_claims_at_the_end_of_a_gap_are_still_claims(upright_bench, decimated):
    """Two numbers nearly alike are subtracted there; but no variance is zero or less."""
    found, _ = smoothed(upright_bench, decimated(upright_bench, RATE_HZ, GAP), upright_bench.q[0])
    assert (found.variance > 0.0).all()


def test_readings_that_no_motion_explains_are_doubted(level_bench, level, decimated):
    """One sensor is knocked for 40 ms; told so, the smoother is hardly worse for it."""
    struck = decimated(level_bench, RATE_HZ)
    struck.values[500:510, 0] += 20.0
    found, off = smoothed(level_bench, struck, level_bench.q[0])
    assert found.doubted * len(struck.values) == pytest.approx(10, abs=5)
    assert np.rad2deg(off[:, ::3]).mean() < np.rad2deg(level[1][:, ::3]).mean() + 0.3


def test_it_follows_the_branches_of_a_tree(branching, recorded, decimated):
    """As it does a chain; gravity is askew, so that it shows every joint."""
    arm = replace(branching, gravity_m_s2=(-5.0, 3.0, -8.0))
    bench = recorded(arm, Bench(2000.0, trial_s=4.0, learning=2, evaluating=0), 3, 1.0)
    readings = decimated(bench, RATE_HZ)
    found = Smoother(arm, bench.q[0], True).smooth(readings)
    off = np.abs(found.states[:, :9] - truth_of(bench, readings))[:, ::3]
    assert found.converged and np.rad2deg(off).max() < 0.5  # a chain of three such joints: 0.15
