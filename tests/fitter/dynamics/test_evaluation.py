"""Scores of a calibrated arm."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.effects.resisting_torque import resisting_torque
from arm.model import Control, Effect, Friction
from arm.newton_euler import inverse_dynamics
from fitter.data.trial import Trial
from fitter.dynamics.evaluation import motion_error, score, torque_explained, torque_rms
from fitter.kinematics.tip_error import tip_score
from limbcal.errors import DataError
from tracking.model.draws import Draws

ARM = load_arm("dd-arm")
MEASURED = replace(ARM, control=Control())


def heavier(arm, friction=0.05):
    joints = [replace(joint, friction=Friction(viscous_N_m_s=friction)) for joint in arm.joints]
    return replace(arm, joints=tuple(joints))


def test_the_true_arm_moves_like_itself(bench_trials):
    own = score(ARM, bench_trials)
    assert own.angle_max_deg < 1e-3
    assert max(own.torque_rms_N_m) < 1e-9
    measured = score(MEASURED, bench_trials)
    assert measured.angle_max_deg < 0.03  # torque between samples is taken for a straight line; it jumps once


def test_another_arm_does_not(bench_trials):
    other = score(heavier(ARM), bench_trials)
    assert 0.01 < other.angle_mean_deg < other.angle_max_deg
    trial = bench_trials[0]
    expected = np.sqrt(np.mean(((0.05 + 0.002409) * trial.dq[:, 0] - 0.010918 * np.sign(trial.dq[:, 0])) ** 2))
    moving = np.mean(trial.dq[:, 0] != 0.0)
    assert np.isclose(torque_rms(heavier(ARM), [trial])[0], expected / np.sqrt(moving), rtol=1e-6)


def test_restarts_keep_the_error_of_a_measured_torque_small(bench_trials):
    trial = bench_trials[0]
    short, long = (np.abs(motion_error(heavier(MEASURED), trial, horizon)).max() for horizon in (0.1, 3.0))
    assert 0.0 < short < long
    stride = 50
    assert np.all(motion_error(heavier(MEASURED), trial, 0.1)[0] == 0.0)
    assert np.any(motion_error(heavier(MEASURED), trial, 0.1)[stride::stride] != 0.0)


def test_a_target_that_nobody_tells_is_estimated(bench_trials):
    assert score(ARM, [replace(trial, ref=None) for trial in bench_trials]).angle_max_deg < 0.1


def test_a_start_between_averaged_readings_tells_nothing_of_the_torque():
    motion = next(motions(ARM, Bench(rate_hz=250.0, learning=1, evaluating=0), seed=0))
    draws = Draws(*(one[None] for one in (motion.q, motion.dq, motion.ddq)), np.zeros((1, len(motion.t), 1, 3)))
    trial = Trial("", motion.t, float(motion.t[1]), motion.q, motion.dq, motion.ddq, draws=draws)
    ddq, dq, start = motion.ddq.copy(), motion.dq.copy(), np.flatnonzero(motion.ddq[:, 1])[0]
    dq[start] += ddq[start] * trial.dt_s / 8.0  # the mean over a step in whose middle the motion starts
    ddq[start] *= 0.5
    averaged = replace(trial, dq=dq, ddq=ddq)
    assert torque_rms(ARM, [averaged]) == pytest.approx(torque_rms(ARM, [trial]), abs=1e-3)
    assert torque_explained(ARM, [averaged]) == pytest.approx([1.0, 1.0], abs=1e-5)


def test_an_arm_that_runs_away_is_infinitely_wrong(bench_trials):
    assert score(heavier(ARM, -100.0), bench_trials[:1]).angle_max_deg == np.inf


def test_effects_at_the_joints_are_of_the_torque(bench_trials):
    rotor = Effect("rotor_inertia", {"inertia_kg_m2": 0.02}, joints=(2,))
    geared = replace(MEASURED, effects=(rotor,))
    alone = [replace(trial, tau=trial.tau + [0.0, 0.02] * trial.ddq, tau_measured=None) for trial in bench_trials]
    assert max(torque_rms(geared, alone)) < 1e-9
    moving = np.concatenate([trial.dq[:, 1] != 0.0 for trial in alone])
    missed = 0.02 * np.concatenate([trial.ddq[:, 1] for trial in alone])[moving]
    filtered = torque_rms(MEASURED, alone)[1]
    assert 0.5 < filtered / np.sqrt(np.mean(missed**2)) <= 1.0 + 1e-9
    assert torque_explained(geared, alone)[1] > 0.999 > torque_explained(MEASURED, alone)[1]


def test_the_tip(bench_trials):
    assert tip_score(ARM, bench_trials).max_mm < 1e-9
    assert tip_score(ARM, bench_trials, "mean").max_mm < 1e-9
    shifted = [replace(trial, tip=trial.tip + 5.0) for trial in bench_trials]  # a base that stands elsewhere
    assert tip_score(ARM, shifted).max_mm < 1e-9
    longer = ARM.with_joints(a_m=np.array([0.25, 0.31]))
    assert 0.1 < tip_score(longer, bench_trials).mean_mm < tip_score(longer, bench_trials).max_mm < 20.0


def test_says_what_is_missing(bench_trials):
    with pytest.raises(DataError, match="no trial"):
        score(ARM, [])
    with pytest.raises(DataError, match="no trial"):
        tip_score(ARM, [])
    with pytest.raises(DataError, match="has no tip"):
        tip_score(ARM, [replace(bench_trials[0], tip=None)])


@pytest.mark.parametrize(
    "effect",
    [
        Effect("periodic_disturbance", {"amplitude_N_m": 1.0, "frequency_hz": 0.37, "phase_rad": 0.0}, (2,)),
        Effect("external_push", {"start_s": 11.0, "duration_s": 0.5, "torque_N_m": 4.0}, (2,)),
        Effect("payload", {"mass_kg": 1.0, "trials": [2]}, ()),
    ],
    ids=lambda effect: effect.name,
)
def test_effects_act_at_the_runs_time_and_in_its_trials(effect):
    """The true arm is as good as its own torque, however often a simulation begins anew."""
    arm, t = replace(MEASURED, effects=(effect,)), np.arange(0.0, 4.0, 0.002)
    phase = np.outer(t, [3.0, 5.1]) + [0.0, 1.0]
    q, dq, ddq = np.sin(phase), np.cos(phase) * [3.0, 5.1], -np.sin(phase) * [9.0, 26.01]
    for number, began_s in ((1, 0.0), (2, 10.0)):
        resisting = resisting_torque(arm, q, dq, ddq, 0.0 * q, began_s + t, number)
        tau = inverse_dynamics(MEASURED, q, dq, ddq) + resisting
        own = score(arm, [Trial("m", t, 0.002, q, dq, ddq, tau, began_s=began_s, number=number)])
        assert max(own.torque_rms_N_m) < 1e-9 and own.angle_max_deg < 0.5
