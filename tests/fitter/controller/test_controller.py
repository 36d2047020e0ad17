"""Gains that nobody knows, found together with the arm."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.bench import Bench, motions
from arm.model import Control, Joint, Link
from arm.regressor import standard_parameters
from fitter.controller.controller import document, fit_controller
from fitter.data.motions import Measured
from fitter.data.trial import Trial
from fitter.data.trials import to_trials
from fitter.dynamics.evaluation import score
from limbcal.command import to_json
from limbcal.errors import ConfigError, DataError, NotIdentifiable
from tests.fitter.controller.test_law_ambiguity import gantry, gantry_trials

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
TRUE = dict(zip(BASE.names, (BASE.combination @ standard_parameters(ARM)).tolist(), strict=True))
#: What somebody may start with: another arm, other gains.
BLANK = replace(
    ARM,
    joints=tuple(
        Joint(a_m=joint.a_m, link=Link(1.0, (0.1, 0, 0), (0, 0.02, 0.02, 0, 0, 0))) for joint in ARM.joints
    ),
    control=Control("pd", (2.0, 3.0), (-1.0, -1.0)),
)


def driven(control, seed=1, learning=4):
    """Return trials of the true arm under another law, at 500 Hz, free of noise."""
    bench = replace(Bench(), rate_hz=500.0, learning=learning, evaluating=0)
    return [
        Trial(f"bench#{i}", m.t, 0.002, m.q, m.dq, m.ddq, m.tau, m.ref)
        for i, m in enumerate(motions(replace(ARM, control=control), bench, seed))
    ]


def under(law, kp, kv=None, ka=None):
    return Control(law, *(() if gain is None else (gain, gain) for gain in (kp, kv, ka)))


def assert_true(fit, but=()):
    for name, value in TRUE.items():
        if name not in but:
            assert fit.parameters[name].value == pytest.approx(value, rel=1e-6, abs=1e-9), name


def assert_said(fit, combination, value):
    """Assert that a combination is said to be known only together, with its value."""
    (said,) = (one for one in fit.only_together if one.startswith(f"{combination} = "))
    assert float(said.split(" = ")[1].split()[0]) == pytest.approx(value, abs=1e-4)


@pytest.mark.parametrize("known", [{"kp1": 9.5}, {"I2": TRUE["I2"]}, {"kv2": -9.5, "D2": TRUE["D2"]}])
def test_one_number_gives_all_the_others(bench_trials, known):
    fit = fit_controller(BLANK, bench_trials[:4], fixed=known)
    assert_true(fit, but=("D1", "D2"))
    for gain in ("kp1", "kp2"):
        assert fit.gains[gain].value == pytest.approx(9.5, rel=1e-6)
        assert fit.gains[gain].identifiable == (gain not in known)
    assert fit.gains["kv1"].value == pytest.approx(-9.5 - TRUE["D1"], rel=1e-6)  # the arm file's friction is zero
    assert not fit.gains["kv1"].identifiable
    assert not fit.parameters["D1"].identifiable
    assert_said(fit, "kv1 - D1", -9.4976)
    assert all(f"{name} = {value:g}" in fit.fixed_by for name, value in known.items())
    assert fit.law_misfit.fits
    assert score(fit.arm, bench_trials[4:]).angle_max_deg < 1e-3


@settings(max_examples=3, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(factor=st.floats(0.05, 20.0))
def test_everything_scales_with_what_is_known(bench_trials, factor):
    first, other = (fit_controller(BLANK, bench_trials[:1], fixed={"kp1": 9.5 * f}) for f in (1.0, factor))
    for name in ("I1+m2*L1^2", "m2*sx2", "m2*sy2", "I2", "fc1", "fc2"):
        assert other.parameters[name].value == pytest.approx(factor * first.parameters[name].value, rel=1e-6)
    assert other.gains["kp2"].value == pytest.approx(factor * first.gains["kp2"].value, rel=1e-6)
    assert score(other.arm, bench_trials[4:]).angle_max_deg < 1e-3


def test_where_nothing_is_known_the_arm_file_is_believed_and_that_is_said(bench_trials):
    fit = fit_controller(BLANK, bench_trials[:4])
    assert fit.parameters["I2"].value == pytest.approx(TRUE["I2"] * 2.0 / 9.5, rel=1e-6)
    assert fit.gains["kp1"].value == 2.0
    assert "nothing was given, so kp1 = 2 of the arm file" in fit.fixed_by


def test_gains_that_are_not_free_are_the_arm_file_s(bench_trials):
    arm = replace(BLANK, control=Control("pd", (9.5, 9.5), (-1.0, -1.0)))
    fit = fit_controller(arm, bench_trials[:4], free_gains={"kv1", "kv2"})
    assert_true(fit, but=("D1", "D2"))
    assert "kp1 = 9.5, kp2 = 9.5 fix the common factor" in fit.fixed_by


def test_unknown_targets_join_the_unknowns(bench_trials):
    untold = [replace(trial, ref=None) for trial in bench_trials[:4]]
    fit = fit_controller(BLANK, untold, fixed={"kp1": 9.5})
    assert_true(fit, but=("D1", "D2", "fc1", "fc2"))  # no joint turns back, so fc is in the unknown constant
    assert any(said.startswith("fc1 does not show by itself") for said in fit.only_together)
    assert fit.gains["kp2"].value == pytest.approx(9.5, rel=1e-6)


def test_torque_measured_in_some_trials_fixes_the_factor(bench_trials):
    rng = np.random.default_rng(0)
    mixed = [
        replace(trial, tau=trial.tau + 0.2 * rng.standard_normal(trial.tau.shape) if number == 0 else None)
        for number, trial in enumerate(bench_trials[:4])
    ]
    fit = fit_controller(BLANK, mixed, measured_torque=True)
    for name in ("kp1", "kp2"):
        assert abs(fit.gains[name].value - 9.5) < 5.0 * fit.gains[name].std
        assert 0.0 < fit.gains[name].std < 0.2
    assert abs(fit.parameters["I2"].value - TRUE["I2"]) < 5.0 * fit.parameters["I2"].std
    assert fit.fixed_by.startswith("the measured torque")
    combination = next(said for said in fit.only_together if said.startswith("kv1 - D1"))
    assert float(combination.split(" = ")[1].split()[0]) == pytest.approx(-9.4976, rel=0.02)


def test_parts_with_factors_of_their_own_need_a_number_each():
    arm, trials = gantry(), gantry_trials(gantry())
    with pytest.raises(NotIdentifiable, match="kp2"):
        fit_controller(arm, trials, fixed={"kp1": 40.0})
    fit = fit_controller(arm, trials, fixed={"kp1": 40.0, "kp2": 60.0})
    assert fit.gains["kv2"].value == pytest.approx(-7.0, rel=1e-5)
    torque = fit_controller(replace(arm, control=under("pd", 1.0, -1.0)), trials, measured_torque=True)
    assert [torque.gains[name].value for name in ("kp1", "kp2")] == pytest.approx([40.0, 60.0], rel=1e-3)


@pytest.fixture(scope="module")
def driven_pda():
    return driven(under("pda", 9.5, -9.5, -1.5))


def test_all_three_gains_of_law_6(driven_pda):
    arm = replace(BLANK, control=under("pda", 1.0, -1.0, -1.0))
    fit = fit_controller(arm, driven_pda, fixed={"I2": TRUE["I2"]})
    assert fit.gains["ka2"].value == pytest.approx(-1.5, rel=1e-5)
    assert fit.gains["ka2"].identifiable
    assert not fit.gains["ka1"].identifiable  # joint 1's own inertia does the same
    assert_said(fit, "I1+m2*L1^2 - ka1", 3.4861)
    both = fit_controller(arm, driven_pda, fixed={"I2": TRUE["I2"], "ka1": -1.5})
    assert both.parameters["I1+m2*L1^2"].value == pytest.approx(TRUE["I1+m2*L1^2"], rel=1e-5)


def test_a_missing_ka_is_seen(driven_pda):
    misfit = fit_controller(BLANK, driven_pda, fixed={"I2": TRUE["I2"]}).law_misfit
    assert not misfit.fits
    assert misfit.missing == ("ka ddq",)
    assert misfit.torque_share[1] > 1e-3
    assert "the law is not of the form (5)" in misfit.sentence


def test_a_missing_kv_passes_for_friction_unless_friction_is_known(bench_trials):
    arm = replace(BLANK, control=under("p", 1.0))
    friction = {name: TRUE[name] for name in ("D1", "D2")}
    fit = fit_controller(arm, bench_trials[:4], fixed={"kp1": 9.5})
    assert fit.parameters["D1"].value == pytest.approx(9.5 + TRUE["D1"], rel=1e-6)
    assert fit.law_misfit.fits
    assert "whether it has kv1, kv2" in fit.law_misfit.sentence
    seen = fit_controller(arm, bench_trials[:4], fixed={"kp1": 9.5, **friction}).law_misfit
    assert not seen.fits
    assert seen.missing == ("kv dq",)


def test_a_wider_form_than_needed_is_told(bench_trials):
    arm = replace(BLANK, control=under("pda", 1.0, -1.0, 0.0))
    fit = fit_controller(arm, bench_trials[:4], fixed={"kp1": 9.5, "ka1": 0.0})
    assert fit.law_misfit.fits
    assert "the narrower form (5)" in fit.law_misfit.sentence
    assert fit.gains["ka2"].value == pytest.approx(0.0, abs=1e-6)


def test_noise_shifts_nothing():
    """Least squares on the same equations puts I2 at 56 % of the truth here."""
    rng = np.random.default_rng(2)
    seen = [
        Measured(t.name, t.name, 0, t.t, {"q": t.q + 0.006 * rng.standard_normal(t.q.shape), "ref": t.ref})
        for t in driven(under("pd", 9.5, -9.5), learning=2)
    ]
    trials = to_trials(seen)
    known = {"kp1": 9.5}
    for polish in (False, True):
        fit = fit_controller(BLANK, trials, fixed=known, polish=polish)
        assert fit.converged
        for name in ("I1+m2*L1^2", "m2*sx2", "m2*sy2", "I2", "fc1", "fc2"):
            found = fit.parameters[name]
            assert abs(found.value - TRUE[name]) < 4.0 * found.std, (polish, name)
        assert fit.law_misfit.fits
    assert fit.parameters["I2"].std < 0.1 * TRUE["I2"]
    assert score(fit.arm, trials).angle_mean_deg < 0.05


@pytest.mark.parametrize("known", [{"D1": 0.1}, {"fc1": 0.0}, {"kv1": -9.5}])
def test_numbers_that_fix_nothing_are_refused(bench_trials, known):
    with pytest.raises(NotIdentifiable, match="factor common to kp1"):
        fit_controller(BLANK, bench_trials[:1], fixed=known)


def test_what_is_asked_wrongly_is_refused(bench_trials):
    trials = bench_trials[:1]
    with pytest.raises(DataError, match="no learning trial"):
        fit_controller(BLANK, [])
    with pytest.raises(ConfigError, match="ka1"):
        fit_controller(BLANK, trials, fixed={"ka1": 1.0})
    with pytest.raises(ConfigError, match="both fixed and free"):
        fit_controller(BLANK, trials, fixed={"kp1": 1.0}, free_gains={"kp1"})
    with pytest.raises(ConfigError, match="kp2 is fixed to 0"):
        fit_controller(BLANK, trials, fixed={"kp2": 0.0})
    with pytest.raises(ConfigError, match="'measured'"):
        fit_controller(replace(BLANK, control=Control()), trials)
    with pytest.raises(ConfigError, match="measured torque"):
        fit_controller(BLANK, trials, fixed={"kp1": 1.0}, measured_torque=True)
    with pytest.raises(DataError, match="no trial has a torque"):
        fit_controller(BLANK, [replace(trials[0], tau=None)], measured_torque=True)
    still = replace(trials[0], q=0 * trials[0].q, dq=0 * trials[0].q, ddq=0 * trials[0].q)
    with pytest.raises(NotIdentifiable, match="no joint moved"):
        fit_controller(BLANK, [still])


def test_the_same_trials_give_the_same_document(bench_trials):
    first, second = (to_json(document(fit_controller(BLANK, bench_trials[:1]))) for _ in range(2))
    assert first == second
    assert '"fixed_by"' in first
