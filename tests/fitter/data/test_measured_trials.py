"""Trials of measured machines, read from end to end."""

import numpy as np
import pytest

from fitter.data.trials import load_trials

DT_S = 0.002
DFKI = "t=time,q=pos_meas{j},tau=tau_meas{j}"


def pendulum_rows(trial):
    """Return the regressor of a two-link pendulum: inertias, first moments, viscous and Coulomb friction."""
    q, dq, ddq = trial.q, trial.dq, trial.ddq
    zero, l1, g = np.zeros(len(q)), 0.2, 9.81
    cos, sin, hang = np.cos(q[:, 1]), np.sin(q[:, 1]), g * np.sin(q.sum(1))
    coupled = cos * (2 * ddq[:, 0] + ddq[:, 1]) - sin * (2 * dq[:, 0] * dq[:, 1] + dq[:, 1] ** 2)
    rough = np.sign(dq)
    first = [ddq[:, 0], ddq.sum(1), l1 * coupled + hang, g * np.sin(q[:, 0]), dq[:, 0], zero, rough[:, 0], zero]
    coupled = cos * ddq[:, 0] + sin * dq[:, 0] ** 2
    second = [zero, ddq.sum(1), l1 * coupled + hang, zero, zero, dq[:, 1], zero, rough[:, 1]]
    return np.stack([np.column_stack(first), np.column_stack(second)], axis=1)


@pytest.mark.parametrize("velocity", ["", ",dq=vel_meas{j}"])
def test_a_measured_double_pendulum(measured_data, velocity):
    """Least squares on six runs explains a held-out swing-up as well as the best that is known, 0.162 N m."""
    folder = measured_data / "dfki_double_pendulum"
    held_out = folder / "20230629-154220.csv"
    learning = [file for file in sorted(folder.glob("*.csv")) if file != held_out]
    learn = load_trials(learning, 2, DFKI + velocity)
    assert len(learn) == 6
    assert learn[0].dt_s == DT_S
    assert "irregular steps" in learn[0].notes[0].text
    assert 6.0 < learn[0].cutoff_hz < 10.0
    (evaluate,) = load_trials([held_out], 2, DFKI + velocity, cutoff_hz=learn[0].cutoff_hz)
    rows = np.concatenate([trial.lowpass(pendulum_rows(trial)) for trial in learn]).reshape(-1, 8)
    torque = np.concatenate([trial.lowpass(trial.tau) for trial in learn]).ravel()
    answer = np.linalg.lstsq(rows, torque)[0]
    residual = evaluate.lowpass(evaluate.tau) - evaluate.lowpass(pendulum_rows(evaluate)) @ answer
    assert np.sqrt(np.mean(residual**2)) < 0.105
    unfiltered = evaluate.tau - pendulum_rows(evaluate) @ answer
    assert np.sqrt(np.mean(unfiltered**2)) < 0.162


def test_a_measured_swing_without_torque(measured_data):
    path = measured_data / "multiarm_pendulum" / "DoublePendulumDataForParameterEstimation.mat"
    trials = load_trials([path], 2, "t=Time_id,q=Y_id[{j}]")
    assert len(trials) == 26
    given = load_trials([path], 2, "t=Time_id,q=Y_id[{j}],dq=Y_id[{j+2}]", cutoff_hz=np.inf)
    assert 20.0 < trials[0].cutoff_hz < 35.0
    trim = (len(given[0].t) - len(trials[0].t)) // 2
    assert np.abs(trials[0].dq - given[0].dq[trim:-trim]).std() < 0.1


def test_cells_of_a_measured_swing_join_to_one(measured_data):
    """Angles there are absolute, pi hangs down, and nothing says the time but the step."""
    path = measured_data / "multiarm_pendulum" / "DoublePendulumDataForParameterEstimation.mat"
    mapping = "t=0.001,q1=Y_id(join)[1]-pi,q2=Y_id(join)[2]-Y_id(join)[1]"
    (trial,) = load_trials([path], 2, mapping)
    assert trial.dt_s == 0.001 and 69.0 < trial.t[-1] < 70.0
    assert np.abs(np.diff(trial.whole["q"], axis=0)).max() < 0.03  # 23 rad/s: nothing jumps from cell to cell


def test_a_measured_servo(measured_data):
    mapping = "t=entries.timestamp,q=entries.position,ref=entries.goal_position"
    mapping += ",on=entries.torque_enable,kp=kp/800"
    trials = load_trials([measured_data / "bam_xl330"], 1, mapping)
    assert len(trials) == 12
    assert all(trial.ref.shape == trial.q.shape for trial in trials)
    assert sorted({float(trial.drives.kp[0, 0]) for trial in trials}) == [0.125, 0.5, 1.0]
    dropped = {trial.name for trial in trials if not trial.drives.on.all()}
    assert dropped == {f"kp{kp}_lift_and_drop" for kp in (100, 400, 800)}


def test_known_pulses_can_be_hidden(measured_data):
    path = measured_data / "dfki_perturbed" / "acrobot-01.csv"
    hidden, full, pulses = (
        load_trials([path], 2, f"t=time,q=pos_meas{{j}},tau={tau}", rate_hz=500.0, cutoff_hz=10.0)[0].tau
        for tau in ("tau_meas{j}-tau_pert{j}", "tau_meas{j}", "tau_pert{j}")
    )
    assert np.abs(full - hidden).max() > 0.1
    assert np.corrcoef((full - hidden).ravel(), pulses.ravel())[0, 1] > 0.9
