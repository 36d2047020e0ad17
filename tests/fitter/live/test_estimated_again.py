"""Motions estimated again from the readings that come with frames, and intervals that hold because of it."""

import numpy as np
import pytest

from arm.base_parameters import base_parameters
from arm.regressor import standard_parameters
from fitter.data.felt import STEP_S
from fitter.dynamics.fit import fit_dynamics
from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler
from protocol.message import FRAMES, TRIAL
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


def test_learning_motions_have_draws(calibrated):
    calibration, _ = calibrated
    for trial in calibration.learn:
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
