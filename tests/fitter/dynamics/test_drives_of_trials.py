"""Trials under gains of their own, and with drives that are let go: the fit, the score, the simulation."""

from dataclasses import replace

import numpy as np
import pytest

from arm.drive_state import DriveState
from arm.model import Arm, Control, Friction, Joint, Link
from arm.regressor import standard_parameters
from arm.simulation import simulate
from arm.structural_parameters import structural_parameters
from fitter.controller.controller import fit_controller
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.motion import drive_torque, sharp_torque
from fitter.dynamics.evaluation import score
from fitter.dynamics.fit import fit_dynamics
from limbcal.errors import ConfigError

ARM = Arm(
    "pendulum",
    (
        Joint(
            a_m=0.3,
            friction=Friction(0.05, 0.03),
            link=Link(0.5, (0.2, 0.0, 0.0), (0.0, 0.0, 0.03, 0.0, 0.0, 0.0)),
        ),
    ),
    gravity_m_s2=(9.81, 0.0, 0.0),
    control=Control("pd", (3.0,), (-0.05,)),
)
STEP_S, N, FINE = 2e-3, 2000, 4


@pytest.fixture(scope="module")
def trials():
    """Three trials at three gains; in the last 1.2 s of each the drive is let go."""
    made = []
    for k, kp in enumerate((2.0, 5.0, 12.0)):
        t = STEP_S * np.arange(N)
        ref = (0.9 * np.sin((2.0 + k) * t) + 0.4 * np.sin(5.3 * t + k))[:, None]
        on = (t < 2.8)[:, None]
        gain = np.full((N, 1), kp)
        drives = DriveState(np.repeat(on, FINE, 0), np.repeat(gain, FINE, 0))
        q = simulate(ARM, np.repeat(ref, FINE, 0), STEP_S / FINE, np.zeros(1), drives=drives).q[::FINE]
        columns = {"q": q, "ref": ref, "on": on.astype(float), "kp": gain}
        made.append(Measured(f"kp{kp:g}", "made", 0, t, columns))
    return to_trials(made, cutoff_hz=40.0)


def known():
    base = structural_parameters(ARM)
    return dict(zip(base.names, base.combination @ standard_parameters(ARM), strict=True))


@pytest.mark.parametrize("objective", ["motion", "torque", "likelihood"])
def test_one_fit_over_several_gains(trials, objective):
    plain = replace(ARM, joints=tuple(replace(j, friction=Friction(), link=Link()) for j in ARM.joints))
    fit = fit_dynamics(plain, trials, objective=objective)
    for name, value in known().items():
        bound = 0.002 if objective == "motion" else 0.03
        assert fit.parameters[name].value == pytest.approx(value, rel=bound, abs=1e-4), name


def test_the_arm_itself_moves_as_it_was_measured(trials):
    found = score(ARM, trials)
    assert found.angle_max_deg < 0.05 and min(found.explained) > 0.999
    ignored = score(ARM, [replace(trial, drives=None, whole=only_motion(trial)) for trial in trials])
    assert ignored.angle_max_deg > 10.0


def only_motion(trial):
    return {name: trial.whole[name] for name in ("q", "ref")}


def test_a_diagnosis_sees_the_same_torque(trials):
    for trial in trials:
        off = ~trial.drives.on[:, 0]
        settled = off & np.roll(off, 60) & np.roll(off, -60)
        assert np.abs(drive_torque(ARM, trial)[settled]).max() < 1e-3
        sharp = sharp_torque(ARM, trial)[trial.trimmed : trial.trimmed + len(trial.t)]
        assert not sharp[off].any() and np.abs(sharp[~off]).max() > 0.1


def test_gains_that_are_said_are_not_sought(trials):
    with pytest.raises(ConfigError, match="trial kp2 says its gains itself"):
        fit_controller(ARM, trials)
