"""Motions estimated again from the readings that come with frames, and intervals that hold because of it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.base_parameters import base_parameters
from arm.regressor import standard_parameters
from fitter.data.estimated_again import estimated_again, follower_of, recorded_motions
from fitter.data.felt import STEP_S
from fitter.data.recordings import read_frames
from fitter.dynamics.fit import fit_dynamics
from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler
from protocol.message import FRAMES, TRIAL, encode
from protocol.recording import RecordingWriter
from tracking.model.draws import DRAWS
from tracking.tracker import tracker_of

#: As the bench's sensors have: what a converter rounds off is then noise like any other.
NOISE_M_S2 = 0.02


def messages(short_run, method, with_readings=True):
    """Yield what a daemon tells that follows the short run."""
    a = short_run.a + np.random.default_rng(0).normal(0.0, NOISE_M_S2, short_run.a.shape)
    tracker = tracker_of(short_run.arm, method, short_run.bench.rate_hz, short_run.truth["q"][0], 1000.0)
    for begin in range(0, len(a), 640):
        t0_ns = round(begin / short_run.bench.rate_hz * 1e9)
        frames, phases = tracker.push(t0_ns, a[begin : begin + 640])
        for piece in frames:
            names = ("frame0", "t0_ns", "dt_s", "n", "q", "dq", "ddq", "points", "gap", "q_std")
            fields = {name: getattr(piece, name) for name in names} | {"method": method}
            if with_readings:
                fields |= {"a": piece.readings, "a_noise": piece.noise}
            yield FRAMES, fields
        for phase in phases:
            role = "learn" if phase.trial <= short_run.bench.learning else "evaluate"
            yield TRIAL, {"trial": phase.trial, "t_ns": phase.t_ns, "state": phase.kind, "role": role}


def recorded(short_run, path, method, without=()):
    """Record what a daemon tells; frames of the blocks in ``without`` are lost."""
    with RecordingWriter(path, "schema = 1", "", clock=lambda: 0.0) as writer:
        for number, (topic, fields) in enumerate(messages(short_run, method)):
            if topic == TRIAL or number not in without:
                writer.write(topic, encode(topic, fields)[1], number)
    return path


def learnt(short_run, method, with_readings=True):
    assembler, calibration = MotionAssembler(), Calibration(short_run.arm)
    stages = []
    for message in messages(short_run, method, with_readings):
        motion = assembler.feed(*message)
        if motion is not None and calibration.add(motion).role == "learn":
            calibration.learn_dynamics()
            stages.append((calibration.kinematics(), calibration.dynamics))
    calibration.conclude()
    return calibration, stages


@pytest.fixture(scope="module", params=["filter", "integrate"])
def calibrated(short_run, request):
    return learnt(short_run, request.param)


def test_all_motions_have_draws(calibrated):
    calibration, _ = calibrated
    for trial in (*calibration.learn, *calibration.evaluate):
        assert trial.dt_s == pytest.approx(STEP_S)
        assert trial.draws is not None and trial.draws.q.shape == (DRAWS, *trial.q.shape)


def test_what_is_claimed_is_so_after_each_motion(calibrated, short_run):
    """No parameter lies further off than Student's distribution with 64 draws lets happen once in 10^5."""
    calibration, stages = calibrated
    base = base_parameters(short_run.arm)
    true = dict(zip(base.names, base.combination @ standard_parameters(short_run.arm), strict=True))
    true |= {f"a{i + 1}": joint.a_m for i, joint in enumerate(short_run.arm.joints)}
    for fits in [*stages, (calibration.kinematics(), calibration.dynamics)]:
        found = {name: p for fit in fits for name, p in fit.parameters.items()}
        claimed = {name: p for name, p in found.items() if p.identifiable and name in true}
        assert len(claimed) >= 6
        for name, p in claimed.items():
            assert p.freedom == DRAWS
            assert abs(p.value - true[name]) < 4.7 * p.std, name


def test_the_geometrys_error_is_in_the_dynamics(calibrated):
    calibration, _ = calibrated
    fit = calibration.kinematics()
    assert fit.drawn.shape == (DRAWS, 2, 5)
    a1 = fit.drawn[:, 0, 1] - fit.parameters["a1"].value
    assert 0.0 < np.sqrt(np.mean(a1**2)) <= fit.parameters["a1"].std * (1.0 + 1e-9)
    exact = fit_dynamics(fit.arm, calibration.learn, examine=False, geometries=None)
    assert exact.parameters["m2*sx2"].std < calibration.dynamics.parameters["m2*sx2"].std


def test_without_readings_one_motion_claims_nothing(short_run):
    _, stages = learnt(short_run, "integrate", with_readings=False)
    for fit in stages[0]:
        assert not any(p.identifiable or np.isfinite(p.std) for p in fit.parameters.values())
    for fit in stages[1]:
        assert {p.freedom for p in fit.parameters.values() if p.identifiable} == {1.0}


def test_a_recording_gives_what_the_stream_gives(short_run, calibrated, tmp_path, request):
    calibration, _ = calibrated
    method = request.node.callspec.params["calibrated"]
    motions = recorded_motions([recorded(short_run, tmp_path / "run.mcap", method)], short_run.arm)
    live = [*calibration.learn, *calibration.evaluate]
    assert [motion.role for motion in motions] == [trial.role for trial in live]
    for motion, trial in zip(motions, live, strict=True):
        np.testing.assert_array_equal(motion.columns["q"], trial.q)
        np.testing.assert_array_equal(motion.draws.q, trial.draws.q)


def test_of_a_motion_estimated_again_more_is_known(short_run, tmp_path):
    """The drift of dead reckoning goes by rests alone; all readings at once show far more of it."""
    path = recorded(short_run, tmp_path / "run.mcap", "integrate")
    tracked, again = read_frames([path], 2)[0], recorded_motions([path], short_run.arm)[0]
    errors = []
    for motion in (tracked, again):
        true = np.stack([np.interp(motion.t, short_run.t, q) for q in short_run.truth["q"].T], axis=1)
        errors.append(np.sqrt(np.mean((motion.columns["q"] - true) ** 2)))
    assert errors[1] < 0.75 * errors[0]
    assert {note.kind for note in again.notes} == {"estimated"} and "drift" in {n.kind for n in tracked.notes}


def test_readings_of_other_sensors_leave_a_motion_as_it_was_tracked(short_run, tmp_path):
    path = recorded(short_run, tmp_path / "run.mcap", "filter")
    arm = replace(short_run.arm, sensors=short_run.arm.sensors[2:])
    for tracked, found in zip(read_frames([path], 2), recorded_motions([path], arm), strict=True):
        np.testing.assert_array_equal(found.columns["q"], tracked.columns["q"])
        assert found.draws is None
        assert "readings of 12 channels, expected 6" in found.notes[-1].text


def test_instants_that_were_lost_do_not_count(short_run, tmp_path):
    """Half a second of the first motion is lost."""
    path = recorded(short_run, tmp_path / "run.mcap", "filter", without=range(14, 17))
    motion = recorded_motions([path], short_run.arm)[0]
    lost = np.flatnonzero(motion.columns["contradicted"].any(axis=1))
    assert {note.kind for note in motion.notes} >= {"uncertain", "estimated"}
    assert 0 < len(lost) < 0.5 * len(motion.t)


@pytest.mark.parametrize("moving", [0, 3])
def test_a_motion_that_is_nearly_all_rest_stays_as_it_was_tracked(short_run, tmp_path, moving):
    tracked = read_frames([recorded(short_run, tmp_path / "run.mcap", "filter")], 2)[0]
    follower = follower_of(short_run.arm)
    felt = tracked.felt
    known = follower.follow(felt.readings, felt.q, felt.q_std, felt.end_q)
    still = np.ones_like(known.still)
    still[len(still) // 2 : len(still) // 2 + moving] = False
    late = replace(tracked, t=felt.t_s[len(still) // 2] + tracked.t - tracked.t[0])
    found = estimated_again(SimpleNamespace(follow=lambda *_: replace(known, still=still)), late)
    assert found.columns is late.columns and found.notes[-1].kind == "tracked"
