"""What the smoother gives out, in the form in which a tracker does."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.kinematics import sensor_positions, tip_position
from arm.model import SensorCovariance
from limbcal.errors import DataError
from tracking.model.initial_state import ROUGH, MountingPrior
from tracking.model.noise import Noise
from tracking.model.observation import observation_of
from tracking.model.readings import Readings
from tracking.smoother import smoothed_frames
from tracking.smoother.smoothed_frames import Found, _found, _phases, most_probable, smooth_motion
from tracking.smoother.windows import Window

RATE_HZ = 250.0


@pytest.fixture(scope="module")
def upright(upright_bench, decimated):
    return smooth_motion(upright_bench.arm, decimated(upright_bench, RATE_HZ), upright_bench.q[0])


@pytest.fixture(scope="module")
def level(level_bench, decimated):
    return smooth_motion(level_bench.arm, decimated(level_bench, RATE_HZ), level_bench.q[0])


def test_frames_are_all_of_the_recording(upright_bench, upright, gather):
    frames = upright.frames
    assert (frames.frame0, frames.t0_ns, frames.dt_s, frames.n) == (0, 2_000_000, 0.004, 2000)
    assert not frames.gap
    for values, name in ((frames.q, "q"), (frames.dq, "dq"), (frames.ddq, "ddq")):
        assert values.shape == (2000, 2)
        k = {"q": 0, "dq": 1, "ddq": 2}[name]
        np.testing.assert_array_equal(values, upright.smoothed.states[:, k:6:3])
    np.testing.assert_allclose(frames.q_std, np.sqrt(upright.smoothed.variance[:, ::3]))
    np.testing.assert_array_equal(frames.tip, tip_position(upright_bench.arm, frames.q))
    tracked = gather(upright_bench, [frames], upright.phases)
    assert tracked.error_deg().mean() < 0.02
    assert (np.abs(tracked.q - tracked.truth()) < 3 * frames.q_std).mean() > 0.95


def test_it_is_better_than_the_live_frames(level_bench, level, gather, followed):
    live = followed(level_bench, level_bench.q[0], rate_hz=RATE_HZ)[0]
    assert gather(level_bench, [level.frames], []).error_deg().mean() < live.error_deg().mean()


def test_motions_are_numbered(level):
    assert [(p.kind, p.trial) for p in level.phases] == [
        (kind, trial) for trial in (1, 2, 3) for kind in ("begin", "end")
    ]
    begins = [1e-9 * p.t_ns for p in level.phases if p.kind == "begin"]
    np.testing.assert_allclose(begins, [0.5, 7.25, 14.0], rtol=0, atol=0.05)


def test_sensors_go_where_they_went(upright_bench, upright):
    """By dead reckoning: a centimetre at the end of a motion of three seconds."""
    places = sensor_positions(upright_bench.arm, upright_bench.q[8::16])
    off = np.abs(upright.frames.points - (places - places[0]))
    assert np.abs(places - places[0]).max() > 0.03
    assert off[700].max() < 0.01


def test_gravity_finds_what_nobody_measured(upright_bench, decimated, gather):
    found = smooth_motion(upright_bench.arm, decimated(upright_bench, RATE_HZ), None)
    assert gather(upright_bench, [found.frames], found.phases).error_deg().max() < 0.1


def test_a_gap_is_said(upright_bench, decimated, gather):
    readings = decimated(upright_bench, RATE_HZ, slice(4000, 6400))
    found = smooth_motion(upright_bench.arm, readings, upright_bench.q[0])
    assert found.frames.gap and found.frames.n == 2000
    for values in (found.frames.q, found.frames.tip, found.frames.points, found.frames.q_std):
        assert np.isfinite(values).all()
    tracked = gather(upright_bench, [found.frames], found.phases)
    assert (np.abs(tracked.q - tracked.truth()) < 4 * found.frames.q_std).mean() > 0.99


@pytest.mark.parametrize("calibrated", [True, False])
def test_only_sensors_that_were_never_calibrated_may_sit_otherwise(monkeypatch, dd_arm, calibrated):
    covariance = SensorCovariance(("s1 bias_x",), ((1.0,),)) if calibrated else None
    arm, tried = replace(dd_arm, sensor_covariance=covariance), []

    def smoother(*made):
        tried.append(made[3:])
        return SimpleNamespace(smooth=lambda *_, **__: SimpleNamespace(is_exact=False, discrepancy=None))

    robust = SimpleNamespace(smooth=lambda *_, **__: "with what the model lacks")
    monkeypatch.setattr(smoothed_frames, "Smoother", smoother)
    monkeypatch.setattr(smoothed_frames, "DiscrepancySmoother", lambda *_: robust)
    assert most_probable(arm, None, np.zeros(2), True) == "with what the model lacks"
    otherwise = [(MountingPrior(), False), (MountingPrior(), True), (ROUGH, False), (ROUGH, True)]
    assert tried == ([(None, False), (None, True)] if calibrated else [(None, False), *otherwise])


class Tries:
    """Stands for smoothers, of which some explain the readings and some find no motion at all."""

    def __init__(self, monkeypatch, exact=(), fails=()):
        self.exact, self.fails, self.seen, self.robust = exact, fails, [], []
        monkeypatch.setattr(smoothed_frames, "Smoother", self._smoother)
        monkeypatch.setattr(
            smoothed_frames, "DiscrepancySmoother", lambda *_: SimpleNamespace(smooth=self._lacking)
        )
        monkeypatch.setattr(smoothed_frames, "replace", lambda one, **what: SimpleNamespace(**vars(one), **what))
        monkeypatch.setattr(smoothed_frames, "_elsewhere", lambda of, final: ("elsewhere", of, final))

    def _smoother(self, arm, q, given, mounting, clocks):
        kind = {None: "file", MountingPrior(): "careful", ROUGH: "rough"}[mounting] + "+clocks" * clocks

        def smooth(readings, **how):
            self.seen.append((kind, how))
            if kind in self.fails:
                raise DataError("no motion")
            return SimpleNamespace(kind=kind, is_exact=kind in self.exact, final="final", discrepancy=None)

        return SimpleNamespace(smooth=smooth, observation="observation")

    def _lacking(self, readings, exact, known, **how):
        self.robust.append((exact and exact.kind, known, how))
        return SimpleNamespace(kind="lacking", discrepancy="sizes")


ORDER = ["file", "careful", "careful+clocks", "rough", "rough+clocks"]


@pytest.mark.parametrize("k", range(5))
def test_what_departs_least_is_found_and_gone_on_with(monkeypatch, dd_arm, k):
    tries = Tries(monkeypatch, exact=ORDER[k:])
    found = _found(dd_arm, None, np.zeros(2), True)
    assert [kind for kind, _ in tries.seen] == ORDER[: k + 1]
    assert tries.seen[-1][1] == {"previous": None, "until": None, "explaining": k > 0}
    assert (found.departure, found.smoothed.kind) == (k, ORDER[k])
    rough = ORDER[k].startswith("rough")
    assert found.smoothed.mounted_elsewhere == (("elsewhere", "observation", "final") if rough else None)
    tries.seen.clear()
    after = _found(dd_arm, None, np.zeros(2), True, found, 70)
    assert (
        tries.seen == [(ORDER[k], {"previous": found.smoothed, "until": 70, "explaining": False})]
        and after.departure == k
    )
    assert not tries.robust


@pytest.mark.parametrize(
    ("fails", "tried", "exact"), [((), 5, "file"), (("file",), 1, None), (("careful",), 2, "file")]
)
def test_else_what_the_model_lacks_is_sought_from_the_file_s_motion(monkeypatch, dd_arm, fails, tried, exact):
    tries = Tries(monkeypatch, fails=fails)
    found = _found(dd_arm, None, np.zeros(2), True)
    assert [kind for kind, _ in tries.seen] == ORDER[:tried]
    assert (found.departure, found.smoothed.kind) == (5, "lacking")
    tries.seen.clear()
    _found(dd_arm, None, np.zeros(2), True, found, 9)
    assert not tries.seen  # what the window before lacked this one does too
    nothing = {"previous": None, "until": None}
    assert tries.robust == [
        (exact, None, nothing),
        (None, found.smoothed, {"previous": found.smoothed, "until": 9}),
    ]
    known_to_be_exact = SimpleNamespace(kind="rough", discrepancy=None)
    _found(dd_arm, None, np.zeros(2), True, Found(3, known_to_be_exact), None)
    assert tries.robust[-1][:2] == ("rough", None)


@pytest.mark.parametrize(
    ("resting", "expected"),
    [
        ("1100011001", [("begin", 2, 1), ("end", 5, 1), ("begin", 7, 2), ("end", 9, 2)]),
        ("0011100000", [("begin", 0, 1), ("end", 2, 1), ("begin", 5, 2)]),
        ("1111111111", []),
    ],
)
def test_a_motion_has_the_times_of_its_first_frame_and_of_the_next_rest(resting, expected):
    readings = SimpleNamespace(t0_s=0.5, dt_s=0.25)
    phases = _phases(np.array([flag == "1" for flag in resting]), readings)
    assert [(p.kind, p.t_ns, p.trial) for p in phases] == [
        (kind, 500_000_000 + 250_000_000 * k, trial) for kind, k, trial in expected
    ]


def test_largest_departures_of_mountings_are_said(dd_arm):
    of, size = observation_of(dd_arm, mountings=True)
    final, first = np.zeros(size), of.mounting_column
    final[first[0] : first[0] + 9] = [9.0, 9.0, 9.0, 0.3, 0.0, 0.4, 0.0, 0.0, 0.01]
    final[first[3] : first[3] + 9] = [9.0, 9.0, 9.0, 0.0, 0.2, 0.0, -0.02, 0.03, 0.06]
    assert smoothed_frames._elsewhere(of, final) == pytest.approx((0.07, 0.5))


@pytest.mark.parametrize("q0", [None, np.array([0.3, -0.2])])
def test_windows_are_joined_where_one_ends(monkeypatch, dd_arm, q0):
    """Whether a motion goes on a window says after its first quarter of a second, and of what lies ahead of it."""
    rng, asked, drawn = np.random.default_rng(0), [], []
    windows = [Window(0, 12, 20), Window(12, 30, 30)]
    resting = [np.array([3, 14, 3]), np.array([5, 5, 8])]  # frames of rest, of motion, of rest
    values = rng.normal(size=(30, 12))
    values[25] = np.nan
    readings = Readings(values, 0.05, 0.5, Noise(np.ones(12), np.ones(12)), 1)

    def found(arm, part, q, given, before, until):
        w, n = len(asked), len(part.values)
        asked.append((part.values, q.copy(), given, before, until))
        flags = np.repeat([True, False, True], resting[w])
        one = SimpleNamespace(states=rng.normal(size=(n, 20)), resting=flags, still=rng.random(n) < 0.5, w=w)
        one.found = SimpleNamespace(variance=rng.random((n, 8)))
        one.variance, one.summary = one.found.variance[:, :6], ("summary", w)
        drawn.append(one)
        return Found(w, one)

    monkeypatch.setattr(smoothed_frames, "_found", found)
    monkeypatch.setattr(smoothed_frames, "windows_of", lambda _: windows)
    felt = []
    paths = SimpleNamespace(follow=lambda *what: felt.append(what) or "paths")
    monkeypatch.setattr(smoothed_frames, "SensorPaths", lambda *_: paths)
    motion = smooth_motion(dd_arm, readings, q0)
    kept = [(drawn[0], slice(0, 12)), (drawn[1], slice(0, 18))]
    states = np.vstack([one.states[part] for one, part in kept])
    frames = motion.frames
    for k, name in enumerate(("q", "dq", "ddq")):
        np.testing.assert_array_equal(getattr(frames, name), states[:, k:6:3])
    np.testing.assert_allclose(frames.q_std**2, np.vstack([one.variance[part, ::3] for one, part in kept]))
    ((q, left, still),) = felt
    np.testing.assert_array_equal(q, frames.q)
    np.testing.assert_array_equal(left, values - states[:, 6:18])
    np.testing.assert_array_equal(still, np.concatenate([one.still[part] for one, part in kept]))
    assert (frames.points, frames.gap, frames.frame0, frames.t0_ns) == ("paths", True, 0, 500_000_000)
    assert [(p.kind, p.t_ns) for p in motion.phases] == [("begin", 650_000_000), ("end", 1_600_000_000)]
    assert (motion.windows, motion.lengths) == ((("summary", 0), ("summary", 1)), (12, 18))
    first, second = asked
    np.testing.assert_array_equal(first[1], np.zeros(2) if q0 is None else q0)
    assert first[2:] == (q0 is not None, None, 12)
    np.testing.assert_array_equal(second[1], frames.q[11])
    assert second[2:] == (True, Found(0, ("summary", 0)), None)
    np.testing.assert_array_equal(second[0], values[12:])
