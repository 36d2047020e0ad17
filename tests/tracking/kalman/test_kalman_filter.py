"""The live tracker along bench motions, against the truth at each frame's own time."""

from dataclasses import replace

import numpy as np
import pytest

from arm.bench import Bench
from limbcal.errors import ConfigError, DataError
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.frames import Phase
from tracking.model.noise import StepWatch

#: Frames of most tests; coarser ones are as right and come sooner.
RATE_HZ = 250.0


@pytest.fixture(scope="module")
def level(level_bench, followed):
    return followed(level_bench, level_bench.q[0])


@pytest.fixture(scope="module")
def upright(upright_bench, followed):
    return followed(upright_bench, upright_bench.q[0], rate_hz=RATE_HZ)


def with_sensors(arm, **fields):
    return replace(arm, sensors=tuple(replace(sensor, **fields) for sensor in arm.sensors))


def through_a_gap(recording, gather, begin, end):
    """Follow an arm, losing the samples from ``begin`` to ``end``; return also what came out of the gap itself."""
    tracker = KalmanTracker(recording.arm, recording.rate_hz, recording.q[0], RATE_HZ)
    frames, phases = tracker.push(0, recording.readings[:begin])
    inside, _ = tracker.gap(end - begin)
    after, _ = tracker.push(round(end * recording.dt_ns), recording.readings[end:])
    rest, _ = tracker.flush()
    return gather(recording, [*frames, *inside, *after, *rest], phases), inside, after


def test_the_level_arm_is_followed(level):
    """Half a degree at most on average, with noise as the standard bench has it but an eighth of its samples."""
    tracked, tracker = level
    assert tracked.error_deg().mean(axis=0).max() < 0.5
    assert (np.abs(tracked.q - tracked.truth()) < 3 * tracked.q_std).mean() > 0.95
    said = tracker.consistency()
    assert said.size < 1.5 and said.doubted == 0 and not said.wrong


def test_three_motions_are_three(level):
    tracked, _ = level
    assert [(p.kind, p.trial) for p in tracked.phases] == [
        (kind, trial) for trial in (1, 2, 3) for kind in ("begin", "end")
    ]
    begins = [1e-9 * p.t_ns for p in tracked.phases if p.kind == "begin"]
    np.testing.assert_allclose(begins, [0.5, 7.25, 14.0], rtol=0, atol=0.05)


def test_speeds_and_accelerations_are_followed(level):
    tracked, _ = level
    for name, share in (("dq", 0.05), ("ddq", 0.15)):
        truth = tracked.truth(name)
        off = np.sqrt(np.mean((getattr(tracked, name) - truth) ** 2))
        assert off < share * np.sqrt(np.mean(truth**2)), name


def test_gravity_holds_the_angles_of_an_upright_arm(upright):
    tracked, _ = upright
    assert tracked.error_deg().mean(axis=0).max() < 0.05
    assert (np.abs(tracked.q - tracked.truth()) < 3 * tracked.q_std).mean() > 0.95


def test_gravity_finds_the_angles_of_an_upright_arm(upright_bench, followed):
    """Nobody says where it rests; after the first motion they are right to 0.3 degrees."""
    tracked, _ = followed(upright_bench, None, rate_hz=RATE_HZ)
    end = next(p.t_ns for p in tracked.phases if p.kind == "end")
    assert tracked.error_deg()[tracked.t_ns > end].max() < 0.3


def test_a_given_angle_may_be_off_by_a_hundredth(upright_bench, followed):
    """As whoever measured it may have been; gravity puts it right, and the claim is kept."""
    tracked, _ = followed(upright_bench, upright_bench.q[0] + [0.006, -0.01], rate_hz=RATE_HZ)
    assert tracked.error_deg()[-1].max() < 0.15
    assert (np.abs(tracked.q - tracked.truth()) < 3 * tracked.q_std).mean() > 0.9


@pytest.mark.parametrize("block", [64, 999, 3000])
def test_frames_are_the_same_however_blocks_are_cut(upright_bench, upright, followed, block):
    tracked, _ = followed(upright_bench, upright_bench.q[0], rate_hz=RATE_HZ, block=block)
    np.testing.assert_array_equal(tracked.number, upright[0].number)
    np.testing.assert_array_equal(tracked.t_ns, upright[0].t_ns)
    for name in ("q", "dq", "ddq", "tip", "points", "q_std"):
        np.testing.assert_allclose(getattr(tracked, name), getattr(upright[0], name), rtol=0, atol=1e-9)
    assert tracked.phases == upright[0].phases


@pytest.mark.parametrize("rate_hz", [RATE_HZ, 1000.0])
def test_a_frame_is_at_its_centre_sample(vertical_arm, upright_bench, rate_hz):
    """Counted from what the latest block says of its own time; a gap counts too."""
    tracker = KalmanTracker(vertical_arm, 4000.0, upright_bench.q[0], rate_hz)
    begun, factor = 1_000_000_007, round(4000.0 / rate_hz)
    frames, _ = tracker.push(begun, upright_bench.readings[:1500])
    frames += tracker.gap(101)[0]
    frames += tracker.push(begun + 1601 * 250_000, upright_bench.readings[1601:2500])[0]
    frames += tracker.flush()[0]
    number = np.concatenate([f.frame0 + np.arange(f.n) for f in frames])
    np.testing.assert_array_equal(number, np.arange(len(range(factor // 2, 2500, factor))))
    for f in frames:
        assert f.t0_ns == begun + 250_000 * (f.frame0 * factor + factor // 2)
        assert f.dt_s == factor / 4000.0
        assert f.q.shape == f.dq.shape == f.ddq.shape == f.q_std.shape == (f.n, 2)
        assert f.tip.shape == (f.n, 3) and f.points.shape == (f.n, 4, 3)


def test_a_gap_is_bridged(upright_bench, gather):
    """0.6 s of the first motion: frames go on, ever less certain, as far off as they say and not at zero."""
    tracked, inside, after = through_a_gap(upright_bench, gather, 4000, 6400)
    np.testing.assert_array_equal(tracked.number, np.arange(len(tracked.number)))
    np.testing.assert_array_equal(np.diff(tracked.t_ns), 4_000_000)
    assert all(f.gap for f in inside if f.t0_ns >= 1_000_000_000) and after[0].gap
    within = (tracked.t_ns >= 1_002_000_000) & (tracked.t_ns < 1_600_000_000)
    assert within.sum() > 140
    assert (np.diff(tracked.q_std[within], axis=0) > 0).all()
    assert np.isfinite(tracked.q).all() and (np.abs(tracked.q[within]) > 1e-3).all()
    later = tracked.t_ns >= 1_000_000_000
    assert (np.abs(tracked.q - tracked.truth())[later] < 4 * tracked.q_std[later]).all()
    assert tracked.error_deg()[-1].max() < 0.3


def test_a_long_gap_is_counted_and_recovered_from(upright_bench, gather):
    """2 s, of which one is bridged; gravity then shows where the arm is."""
    tracked, inside, after = through_a_gap(upright_bench, gather, 4000, 12_000)
    bridged = [f for f in inside if f.t0_ns >= 1_000_000_000]
    assert sum(f.n for f in bridged) == RATE_HZ * 1.0
    assert after[0].frame0 == len(range(8, 12_000, 16)) and after[0].gap and not after[1:]
    np.testing.assert_array_equal(tracked.t_ns, (tracked.number * 16 + 8) * 250_000)
    last = tracked.t_ns > 6_000_000_000
    assert tracked.error_deg()[last].max() < 0.3
    assert (np.abs(tracked.q - tracked.truth())[last] < 4 * tracked.q_std[last]).all()


def test_a_gap_before_anything_was_learnt_is_counted(upright_bench, gather):
    tracked, inside, after = through_a_gap(upright_bench, gather, 0, 160)
    assert not inside and after[0].gap
    assert after[0].frame0 == 10 and tracked.error_deg().max() < 0.3


def test_ac_coupled_sensors_are_followed(dd_arm, recorded, followed):
    arm = with_sensors(dd_arm, highpass_hz=0.2)
    recording = recorded(arm, Bench(4000.0, learning=3, evaluating=0), 1, 1.0)
    tracked, tracker = followed(recording, recording.q[0], rate_hz=RATE_HZ)
    assert tracked.error_deg().mean(axis=0).max() < 1.5
    assert (np.abs(tracked.q - tracked.truth()) < 3 * tracked.q_std).mean() > 0.95
    assert not tracker.consistency().wrong


def test_a_sensor_elsewhere_than_said_is_noticed(level_bench, dd_arm, followed):
    s3 = replace(dd_arm.sensors[2], position_m=(0.13, 0.0, 0.0))
    wrong = replace(dd_arm, sensors=(*dd_arm.sensors[:2], s3, dd_arm.sensors[3]))
    said = followed(level_bench, level_bench.q[0], wrong, RATE_HZ)[1].consistency()
    assert said.wrong and said.size > 2.0
    assert not followed(level_bench, level_bench.q[0], dd_arm, RATE_HZ)[1].consistency().wrong


def test_lengths_may_be_guesses(level_bench, dd_arm, followed):
    """Twice the first link's length makes no angle worse by more than a tenth of a degree."""
    guessed = dd_arm.with_joints(a_m=np.array([0.5, 0.3]))
    right = followed(level_bench, level_bench.q[0], dd_arm, RATE_HZ)[0].error_deg().mean(axis=0)
    tracked, tracker = followed(level_bench, level_bench.q[0], guessed, RATE_HZ)
    assert (tracked.error_deg().mean(axis=0) < right + 0.1).all()
    assert not tracker.consistency().wrong


def test_a_converter_without_noise_is_not_trusted_beyond_its_steps(dd_arm, recorded, followed):
    """At rest its readings never change; that says nothing of how finely it tells a motion."""
    recording = recorded(dd_arm, Bench(4000.0, trial_s=4.0, learning=1, evaluating=0), 1, 0.0)
    tracked, tracker = followed(recording, recording.q[0], rate_hz=RATE_HZ)
    assert not tracker.consistency().wrong
    assert (np.abs(tracked.q - tracked.truth()) < 3 * tracked.q_std).mean() > 0.9


def test_too_little_gives_nothing_and_a_little_more_does(dd_arm):
    tracker = KalmanTracker(dd_arm, 4000.0, None)
    assert tracker.push(0, np.zeros((7, 12))) == ([], []) == tracker.flush()
    assert tracker.consistency().size is None
    readings = np.tile([0.0, 0.0, 9.80665], (12, 4))
    tracker = KalmanTracker(dd_arm, 4000.0, None)
    tracker.push(0, readings)
    frames, phases = tracker.flush()
    assert sum(f.n for f in frames) == 3 and not phases


def test_mistakes_are_named(dd_arm):
    with pytest.raises(ConfigError, match=r"initial_q_rad has shape \(3,\)"):
        KalmanTracker(dd_arm, 4000.0, np.zeros(3))
    for rate_hz in (0.0, -1.0):
        with pytest.raises(ConfigError, match="frame_rate_hz"):
            KalmanTracker(dd_arm, 4000.0, None, rate_hz)
    with pytest.raises(ConfigError, match="no \\[\\[sensor\\]\\]"):
        KalmanTracker(replace(dd_arm, sensors=(), tip=None), 4000.0, None)
    for shape in ((5, 11), (12,)):
        with pytest.raises(DataError, match="readings have shape"):
            KalmanTracker(dd_arm, 4000.0, None).push(0, np.zeros(shape))


def test_phases_are_frames_of_their_own_time(upright):
    tracked, _ = upright
    assert all(isinstance(p, Phase) and p.t_ns in tracked.t_ns for p in tracked.phases)


def test_a_rate_that_is_found_while_the_arm_rests_is_as_good_as_one_that_was_known(level_bench):
    bench = level_bench
    n, rest = round(4.0 * bench.rate_hz), round(0.4 * bench.rate_hz)
    known = KalmanTracker(bench.arm, bench.rate_hz, bench.q[0], RATE_HZ)
    found = KalmanTracker(bench.arm, 1.02 * bench.rate_hz, bench.q[0], RATE_HZ)
    right, _ = known.push(0, bench.readings[:n])
    found.push(0, bench.readings[:rest])
    found.retime(bench.rate_hz)
    got, _ = found.push(round(rest * bench.dt_ns), bench.readings[rest:n])
    assert got[-1].dt_s == right[-1].dt_s
    np.testing.assert_allclose(got[-1].q[-1], right[-1].q[-1], rtol=0, atol=np.deg2rad(0.1))
    np.testing.assert_allclose(got[-1].dq[-1], right[-1].dq[-1], rtol=0, atol=0.01)


def test_a_gap_beyond_a_second_is_bridged_for_one(dd_arm):
    rng, rate_hz = np.random.default_rng(0), 1000.0
    rest = np.tile([0.0, 0.0, 9.80665], len(dd_arm.sensors)) + rng.normal(0.0, 0.02, (800, 12))
    for lost, bridged in ((500, 125), (1000, 250), (3000, 250)):
        tracker = KalmanTracker(dd_arm, rate_hz, np.zeros(2), RATE_HZ)
        before, _ = tracker.push(0, rest)
        inside, _ = tracker.gap(lost)
        after, _ = tracker.push(round(1e6 * (800 + lost)), rest)
        predicted = [part for part in inside if part.gap]
        assert sum(len(part.q) for part in predicted) == bridged
        n_before = sum(len(part.q) for part in (*before, *inside) if not part.gap)
        assert (n_before, after[0].frame0) == (200, (800 + lost) // 4)
        assert after[0].gap and not any(part.gap for part in after[1:])


def test_blocks_together_give_what_each_gives(upright_bench, monkeypatch):
    """To the last bit, each with its own time; also while the filter begins, and where a finer step is seen."""
    looked = []
    original = StepWatch.takes_quietly
    monkeypatch.setattr(StepWatch, "takes_quietly", lambda *a: looked.append(original(*a)) or looked[-1])
    arm, rate_hz, readings = upright_bench.arm, upright_bench.rate_hz, upright_bench.readings.copy()
    readings[len(readings) // 2 :] += 1e-4 * (np.arange(len(readings) - len(readings) // 2) % 2)[:, None]
    one, other = (KalmanTracker(arm, rate_hz, upright_bench.q[0]) for _ in range(2))
    size = round(0.01 * rate_hz) + 1  # frames do not end with blocks
    starts = range(0, len(readings), size)
    blocks = [(round(k * upright_bench.dt_ns) + k % 7, readings[k : k + size]) for k in starts]
    together, k = [], 0
    for n in [1, 3, 2, 4] * len(blocks):
        together += one.push_all(blocks[k : k + n])
        k += n
        if k >= len(blocks):
            break
    by_itself = [other.push(*block) for block in blocks]
    assert True in looked and False in looked
    assert len(together) == len(by_itself)
    for (frames, phases), (expected, same_phases) in zip(together, by_itself, strict=True):
        assert phases == same_phases
        assert [(f.frame0, f.t0_ns, f.gap) for f in frames] == [(f.frame0, f.t0_ns, f.gap) for f in expected]
        for name in ("q", "dq", "ddq", "tip", "points", "q_std", "readings", "noise"):
            assert [getattr(f, name).tobytes() for f in frames] == [getattr(f, name).tobytes() for f in expected]
    assert one.consistency() == other.consistency()
