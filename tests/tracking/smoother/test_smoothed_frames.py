"""What the smoother gives out, in the form in which a tracker does."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.kinematics import sensor_positions, tip_position
from arm.model import SensorCovariance
from tracking.model.initial_state import ROUGH, MountingPrior
from tracking.smoother import smoothed_frames
from tracking.smoother.smoothed_frames import most_probable, smooth_motion

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
