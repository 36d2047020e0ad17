"""Static friction found where a joint stuck and let go, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.bench import Bench, motions, rest_angles
from arm.model import Control, Estimate, Friction
from arm.newton_euler import inverse_dynamics
from arm.simulation import simulate
from benchmarks.coverage import learn
from benchmarks.coverage_case import draw_case
from fitter.data.trial import Trial
from fitter.dynamics.break_away import static_friction

DT = 0.001


def rubbing(static, coulomb, name="dd-arm"):
    arm = load_arm(name)
    return replace(arm, joints=tuple(replace(j, friction=Friction(0.02, coulomb, static)) for j in arm.joints))


def only_joint(arm, keep):
    """Hold the other joint by a friction that nothing here overcomes."""
    joints = [j if i == keep else replace(j, friction=Friction(0.02, 0.02, 1e6)) for i, j in enumerate(arm.joints)]
    return replace(arm, joints=tuple(joints))


def ramped(arm, rate, seconds=12.0, top=0.3):
    """Targets that rise and fall evenly."""
    t = np.arange(round(seconds / DT)) * DT
    wave = top * (2 * np.abs((t * rate / top / 2 + 0.5) % 2 - 1) - 1)
    ref = np.outer(wave, [1.0 if i % 2 == 0 else -0.7 for i in range(arm.n_joint)])
    m = simulate(arm, ref, DT, np.zeros(arm.n_joint))
    return Trial("ramp", m.t, DT, m.q, m.dq, m.ddq, m.tau, m.ref)


def noisy(trial, tau=0.02, dq=1e-3):
    rng = np.random.default_rng(0)
    shape = trial.q.shape
    return replace(trial, tau=trial.tau + tau * rng.normal(size=shape), dq=trial.dq + dq * rng.normal(size=shape))


@settings(max_examples=8, deadline=None)
@given(static=st.floats(0.05, 0.5), share=st.floats(0.0, 0.7), joint=st.integers(0, 1), rate=st.floats(0.03, 0.1))
def test_a_slow_ramp_brackets_it(static, share, joint, rate):
    arm = only_joint(rubbing(static, share * static), joint)
    found = static_friction(arm, [ramped(arm, rate)])[joint]
    assert found.held <= static * (1 + 1e-9)
    assert found.let_go >= static * (1 - 1e-9)
    assert found.parameter.identifiable
    assert found.parameter.value == pytest.approx(static, abs=4 * found.parameter.std)
    assert found.parameter.std < 0.1 * static
    assert "lies between" in found.why


@pytest.mark.parametrize("name", ["dd-arm", "dd-arm-vertical", "spatial-arm"])
@pytest.mark.parametrize("static", [0.15, 0.3])
def test_all_joints_at_once_with_measured_and_noisy_torque(name, static):
    arm = rubbing(static, 0.04, name)
    trial = ramped(arm, 0.1, 20.0, 0.4)
    for seen, model in ((trial, arm), (noisy(trial), replace(arm, control=Control()))):
        for found in static_friction(model, [seen]):
            assert found.held <= static + 0.01
            assert found.let_go >= static - 0.02
            if found.parameter.identifiable:
                assert found.parameter.value == pytest.approx(static, abs=3.5 * found.parameter.std)
    assert any(found.parameter.identifiable for found in static_friction(model, [seen]))


@pytest.mark.parametrize("name", ["dd-arm", "dd-arm-vertical", "spatial-arm"])
@pytest.mark.parametrize("coulomb", [0.0, 0.06])
def test_nothing_is_invented(name, coulomb):
    arm = rubbing(0.0, coulomb, name)
    slow, jumping = (
        ramped(arm, 0.1, 20.0, 0.4),
        next(motions(arm, replace(Bench(), rate_hz=1000.0, simulation_hz=1000.0), 1)),
    )
    step = Trial("step", jumping.t, DT, jumping.q, jumping.dq, jumping.ddq, jumping.tau, jumping.ref)
    measured = replace(arm, control=Control())
    for model, trials in ((arm, [slow, step]), (measured, [noisy(slow), noisy(step)])):
        for found in static_friction(model, trials):
            assert not found.parameter.identifiable
            assert found.parameter.value == 0.0
            assert found.held <= coulomb + 0.01
            assert found.why


def test_a_jump_of_the_target_is_too_wide_a_bracket():
    arm = only_joint(rubbing(0.1, 0.05), 1)
    ref = np.zeros((4000, 2))
    ref[1000:, 1] = 0.5
    m = simulate(arm, ref, DT, np.zeros(2))
    found = static_friction(arm, [Trial("jump", m.t, DT, m.q, m.dq, m.ddq, m.tau, m.ref)])[1]
    assert not found.parameter.identifiable
    assert 9.5 * 0.5 <= found.let_go <= 9.5  # what a step's rise may hide lies above the load of a sample
    assert "rises slowly would narrow it" in found.why


def test_a_joint_that_never_let_go():
    arm = only_joint(rubbing(0.5, 0.1), 1)
    found = static_friction(arm, [ramped(arm, 0.05, 4.0, 0.05)])
    assert found[1].held == pytest.approx(0.7 * 9.5 * 0.05, rel=0.02)
    assert found[1].let_go == np.inf
    assert "never let go: F2 is at least that" in found[1].why
    assert found[1].parameter.value == 0.5  # the arm's own stays


def test_what_coulomb_friction_explains_depends_on_how_well_it_is_known():
    arm = only_joint(rubbing(0.12, 0.1), 1)
    trial = ramped(arm, 0.05)
    assert static_friction(arm, [trial])[1].parameter.identifiable
    vague = replace(arm, base_parameters={"fc2": Estimate(0.1, 0.02)})
    found = static_friction(vague, [trial])[1]
    assert not found.parameter.identifiable
    assert "Coulomb friction is 0.1 N m: no static friction above it is proved" in found.why


def test_masses_that_are_not_known_hold_nothing():
    """The true arm has no dry friction; it is taken for a heavier one, whose weight seems to be held."""
    true = rubbing(0.0, 0.0, "dd-arm-vertical")
    ref = np.zeros((5000, 2))
    ref[3000:] = 0.1 * DT * np.arange(2000)[:, None]
    m = simulate(true, ref, DT, rest_angles(true, np.zeros(2)))
    trial = Trial("hangs", m.t, DT, m.q, m.dq, m.ddq, m.tau, m.ref)
    heavier = replace(true.joints[1].link, mass_kg=8.1)
    wrong = replace(true, joints=(true.joints[0], replace(true.joints[1], link=heavier)))
    assert any(found.parameter.identifiable for found in static_friction(wrong, [trial]))  # nobody could know
    known_to = {"m2*sx2": Estimate(1.74, 0.0215), "m1*sx1+m2*L1": Estimate(3.2, 0.025)}
    for found in static_friction(replace(wrong, base_parameters=known_to), [trial]):
        assert not found.parameter.identifiable


def test_says_what_is_missing():
    arm = rubbing(0.1, 0.05)
    trial = ramped(arm, 0.1, 2.0)
    assert "needs the target ref1" in static_friction(arm, [replace(trial, ref=None)])[0].why
    measured = replace(arm, control=Control())
    assert "needs the torque tau2" in static_friction(measured, [replace(trial, tau=None)])[1].why
    running = replace(trial, dq=trial.dq + 1.0)
    assert "never stood still" in static_friction(arm, [running])[0].why


def test_a_filter_shows_motion_before_it_begins():
    """Of angles alone motion is seen while the joint still stands, and at a load that did not move it."""
    found = [one for one in learn(draw_case(84078, 2, "q"), None) if one.kind == "static"]
    assert [one.name for one in found] == ["F2"]
    assert all(one.inside for one in found)


def test_a_joint_that_creeps_lets_go_of_nothing():
    """It slides on, more slowly than its velocity's noise shows, and is driven on by less than static friction."""
    dt, n = 0.004, 1000
    arm = rubbing(2.0, 1.0)
    t = np.arange(n) * dt
    speed = np.where(t < 2.0, 2e-4, 2e-4 + 0.5 * np.maximum(t - 2.0, 0.0))
    dq = np.column_stack([np.zeros(n), speed])
    q, ddq = np.cumsum(dq, axis=0) * dt, np.gradient(dq, dt, axis=0)
    tau = inverse_dynamics(arm, q, dq, ddq)
    rng = np.random.default_rng(1)
    dq = dq + 1e-3 * rng.normal(size=dq.shape)
    trial = Trial("creeps", t, dt, q + 1e-6 * rng.normal(size=q.shape), dq, ddq, tau, np.zeros_like(q))
    found = static_friction(replace(arm, control=Control()), [trial])[1]
    assert found.let_go == np.inf
    assert not found.parameter.identifiable
