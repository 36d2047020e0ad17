"""White rows: the residual of a true model is noise of variance 1, and the parameters come back."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.effects.catalogue import catalogue
from arm.regressor import standard_parameters
from arm.simulation import simulate
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.arm_hypotheses import FrictionDrift, GravityTilt
from fitter.diagnosis.drive_hypotheses import Delay, Gain, Lag, Limit
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.errors_in_variables import added, noise_of
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.least_squares import scaled_lstsq
from fitter.diagnosis.model import Model
from fitter.diagnosis.payload import Payload
from fitter.diagnosis.run import run_of
from fitter.diagnosis.transmission_hypotheses import Elasticity
from fitter.diagnosis.weighting import Columns
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression():
    trials = to_trials(swings((), trials=8, seed=2), cutoff_hz=25.0)
    return regression_of(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))


@pytest.fixture(scope="module")
def two_joints():
    return _measured(lambda tau, q: tau)


def _measured(asked):
    """Return two trials of an arm with the torque that was asked of a drive."""
    arm, rng = load_arm("dd-arm-vertical"), np.random.default_rng(0)
    t = np.arange(500) * 0.004
    motions = []
    for k in range(2):
        ref = 0.5 * np.sin(np.outer(t, [3.0, 5.0]) + rng.uniform(0.0, 6.0, 2))
        motion = simulate(arm, ref, 0.004, ref[0])
        columns = {
            "q": motion.q + 2e-4 * rng.normal(size=ref.shape),
            "tau": asked(motion.tau, motion.q) + 0.01 * rng.normal(size=ref.shape),
        }
        motions.append(Measured(f"{k}", "test", 0, t, columns))
    trials = to_trials(motions, cutoff_hz=25.0)
    return regression_of(arm, run_of(arm, trials[:1], trials[1:]))


def test_what_is_left_of_the_true_model_has_the_variance_of_noise(regression):
    x = regression.solve(Model(), regression.learning)
    left = regression.squares(Model(), x)
    n_effective = np.array([regression.weighting.n_effective(motion) for motion in regression.motions])
    assert 0.5 < left[4:].sum() / n_effective[4:].sum() < 2.0


def test_base_parameters_come_back(regression):
    x = regression.solve(Model(), regression.learning)
    base = base_parameters(pendulum())
    np.testing.assert_allclose(x, base.combination @ standard_parameters(pendulum()), rtol=0.02, atol=0.02)


def test_dependent_columns_get_the_shortest_answer():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(50, 2))
    A = np.column_stack([A, A[:, 0]])
    x = scaled_lstsq(A, A[:, 0] + A[:, 1])
    np.testing.assert_allclose(x, [0.5, 1.0, 0.5], atol=1e-6)


def test_noise_in_the_columns_is_what_it_is_expected_to_be():
    """The same run with and without noise tells what noise makes of the columns; one draw foretells its size."""
    quiet, rng = swings((), trials=12, seed=20), np.random.default_rng(0)
    noisy = [
        replace(one, columns={**one.columns, "q": one.columns["q"] + 6e-3 * rng.normal(size=(len(one.t), 1))})
        for one in quiet
    ]
    loud, true = (
        regression_of(pendulum(), run_of(pendulum(), trials, trials[:1]))
        for trials in (to_trials(noisy, cutoff_hz=25.0), to_trials(quiet, cutoff_hz=25.0))
    )
    true.equations = Equations(true.arm, loud.weighting)
    pairs = list(zip(loud.motions, true.motions, strict=True))
    found = [
        noise_of((a.design - b.design).reshape(*a.target.shape, -1), a.target - b.target)
        for a, b in ((loud.rows(Model(), m), true.rows(Model(), replace(n, stuck=m.stuck))) for m, n in pairs)
    ]
    noise = added([loud._noisy.of(Model(), [motion], by_joint=True) for motion in loud.motions])
    inertia = 2
    gram = sum(one.gram for one in found)[0, inertia, inertia]
    rhs = sum(one.rhs for one in found)[0, inertia]
    assert noise.gram[0, inertia, inertia] == pytest.approx(gram, rel=0.15)
    assert noise.rhs[0, inertia] == pytest.approx(rhs, rel=0.5)  # by the law the torque has the angle's noise


def test_a_drive_that_does_nothing_explains_no_noise_whatever_it_is_beside(two_joints):
    """The gear's noise is not the base model's: a gain of one must not be paid for that."""
    gear = Elasticity(catalogue()["joint_elasticity"], (1,))
    alone = Model().plus(gear, np.array([0.02, 0.01]))
    with_gain = alone.plus(Gain(catalogue()["gain_error"], (0,)), np.ones(1))
    x = two_joints.solve(alone, two_joints.learning)
    np.testing.assert_allclose(two_joints.squares(with_gain, x), two_joints.squares(alone, x), rtol=1e-6)


@pytest.mark.parametrize("column", ["load_friction", "cogging", "joint_spring"])
@pytest.mark.parametrize("upstream", ["actuator_lag", "joint_elasticity", "torque_saturation"])
def test_what_acts_first_does_not_depend_on_what_was_found_first(two_joints, upstream, column):
    early = {
        "actuator_lag": (Lag(catalogue()["actuator_lag"], (1,)), np.array([0.02])),
        "torque_saturation": (Limit(catalogue()["torque_saturation"], (1,)), np.array([0.5])),
        "joint_elasticity": (Elasticity(catalogue()["joint_elasticity"], (1,)), np.array([0.02, 0.01])),
    }[upstream]
    late = JointHypothesis(catalogue()[column], 1)
    last = late, np.full(len(late.low), 3.0)
    one, other = Model().plus(*early).plus(*last), Model().plus(*last).plus(*early)
    motion, n = two_joints.motions[0], late.n_column
    assert two_joints.hypothetical(one, motion).columns[-1].shape[-1] == n
    np.testing.assert_array_equal(
        two_joints.hypothetical(other, motion).columns, two_joints.hypothetical(one, motion).columns
    )
    found, again = two_joints.rows(one, motion), two_joints.rows(other, motion)
    np.testing.assert_allclose(again.design, found.design, atol=1e-12)
    np.testing.assert_allclose(again.target, found.target, atol=1e-12)


def test_columns_stand_in_the_order_of_the_model(two_joints):
    spring, cogging = (JointHypothesis(catalogue()[name], 1) for name in ("joint_spring", "cogging"))
    lag = Lag(catalogue()["actuator_lag"], (0,))
    one = Model().plus(cogging, np.array([4.0])).plus(lag, np.array([0.02])).plus(spring, np.zeros(0))
    other = Model().plus(lag, np.array([0.02])).plus(cogging, np.array([4.0])).plus(spring, np.zeros(0))
    motion = two_joints.motions[0]
    np.testing.assert_allclose(two_joints.rows(one, motion).design, two_joints.rows(other, motion).design)


def test_torques_at_one_joint_are_filtered_as_among_all(two_joints):
    motion, weighting = two_joints.motions[0], two_joints.weighting
    torques = np.random.default_rng(0).normal(size=(len(motion.t), 3))
    for joint in range(2):
        rows = np.zeros((len(motion.t), 2, 3))
        rows[:, joint] = torques
        whole = weighting.filtered(motion, rows).reshape(-1, 3)
        np.testing.assert_allclose(weighting.filtered_at(motion, joint, torques), whole, atol=1e-9)


def test_half_the_work_gives_the_same_products(two_joints):
    motion, weighting = two_joints.motions[0], two_joints.weighting
    assert np.any(weighting.axes(motion)[1] < 1.0)  # something is lost in part
    rng = np.random.default_rng(0)
    torques, other = rng.normal(size=(len(motion.t), 3)), rng.normal(size=(len(motion.t), 2, 4))
    for joint in range(2):
        filtered = weighting.filtered_at(motion, joint, torques)
        rows = weighting.filtered(motion, other).reshape(-1, 4)
        columns = Columns(weighting, motion, weighting.whitened_at(motion, joint, torques))
        W, Z = columns.white, columns.lost
        np.testing.assert_allclose(W.T @ W - Z.T @ Z, filtered.T @ filtered, rtol=1e-9)
        np.testing.assert_allclose(W.T @ weighting.freed(motion, rows), filtered.T @ rows, rtol=1e-7, atol=1e-7)


def test_a_gain_makes_of_the_rows_what_it_makes_of_the_regressor(two_joints):
    kind = catalogue()["gain_error"]
    for joint, factor in ((0, 0.7), (1, 1.3)):
        model = Model().plus(Gain(kind, (joint,)), np.array([factor]))
        motion = two_joints.motions[1]
        hypothetical = two_joints.hypothetical(model, motion)
        rows = hypothetical.base(two_joints.equations.independent(hypothetical.arm))
        whole = two_joints.weighting.filtered(motion, rows)
        np.testing.assert_allclose(
            two_joints.rows(model, motion).design, whole.reshape(-1, rows.shape[2]), atol=1e-8
        )


def test_beside_a_gain_a_spring_is_as_stiff_as_it_is():
    """What the joint gets is a share of what was asked for; the spring pulls with all that it has."""
    gain, stiffness = 0.7, 4.0
    weak = np.array([1.0, gain])
    regression = _measured(lambda tau, q: (tau + [0.0, stiffness] * q) / weak)
    spring = JointHypothesis(catalogue()["joint_spring"], 1)
    for model in (
        Model().plus(Gain(catalogue()["gain_error"], (1,)), np.array([gain])).plus(spring, np.zeros(0)),
        Model().plus(spring, np.zeros(0)).plus(Gain(catalogue()["gain_error"], (1,)), np.array([gain])),
    ):
        x = regression.solve(model, regression.motions)
        assert spring.numbers(np.zeros(0), x[-spring.n_column :])[0] == pytest.approx(stiffness, rel=0.1)


@pytest.mark.parametrize("beside", ["joint_spring", "cogging", "load_friction", "gravity_tilt", "payload"])
def test_a_gain_that_comes_last_is_as_one_that_comes_first(two_joints, beside):
    """Whatever is scaled instead of made anew is the same."""
    gain = Gain(catalogue()["gain_error"], (1,))
    other = {
        "gravity_tilt": GravityTilt(catalogue()["gravity_tilt"], ()),
        "payload": Payload(catalogue()["payload"], frozenset({0})),
    }.get(beside) or JointHypothesis(catalogue()[beside], 1)
    model = Model().plus(other, np.full(len(other.low), 3.0)).plus(gain, np.array([0.6]))
    equations = two_joints.equations
    for motion in (two_joints.motions[0], two_joints.noisier[two_joints.motions[0].number]):
        hypothetical = equations.hypothetical(model, motion)
        filtered = equations.weighting.filtered(
            motion, hypothetical.equations(equations.independent(hypothetical.arm))
        )
        design = equations.rows(model, motion).design
        np.testing.assert_allclose(design, filtered.reshape(design.shape), rtol=1e-9, atol=1e-9)
    noisy, motions = two_joints._noisy, two_joints.motions[:1]
    quick, whole = noisy.of(model, motions), noisy._of(model, (), True, motions[0])
    np.testing.assert_allclose(quick.gram, whole.gram, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(quick.rhs, whole.rhs, rtol=1e-6, atol=1e-9)


def test_friction_that_drifts_is_what_the_equations_say(two_joints):
    """Only the columns of friction are made anew, from what they are times the run's time."""
    kind, spring = catalogue()["thermal_drift"], JointHypothesis(catalogue()["joint_spring"], 0)
    model = Model().plus(FrictionDrift(kind, (0,)), np.array([0.03])).plus(spring, np.zeros(0))
    model = model.plus(FrictionDrift(kind, (1,)), np.array([-0.01]))
    equations, motion = two_joints.equations, two_joints.motions[1]
    hypothetical = equations.hypothetical(model, motion)
    np.testing.assert_allclose(hypothetical.drift, [0.03, -0.01])
    filtered = equations.weighting.filtered(
        motion, hypothetical.equations(equations.independent(hypothetical.arm))
    )
    design = equations.rows(model, motion).design
    np.testing.assert_allclose(design, filtered.reshape(design.shape), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("part", [0.0, 0.9])
def test_a_drive_that_changes_nothing_explains_nothing(two_joints, part):
    """However much a model lacks beside the noise: a delay of nothing leaves the equations as they are."""
    regression = two_joints
    regression.floor_part = part
    try:
        model = Model().plus(Delay(catalogue()["actuator_delay"], (0,)), np.array([1e-9]))
        x = regression.solve(model, regression.learning)
        np.testing.assert_allclose(regression.scale(model, x), 1.0, atol=1e-3)
    finally:
        regression.floor_part = 0.0


def test_dry_friction_that_rounding_lets_drive_is_none(monkeypatch):
    trials = to_trials(swings((), trials=8, seed=2), cutoff_hz=25.0)
    lacking = regression_of(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    coulomb = lacking._coulomb(Model(), lacking.motions[0], len(lacking.solve(Model(), lacking.learning)))
    assert np.count_nonzero(coulomb) == 1
    monkeypatch.setattr(lacking, "density", object())
    monkeypatch.setattr(lacking, "_likeliest", lambda _n, x, *_: np.where(coulomb, -1e-18, 1.0))
    x = lacking.solve(Model(), lacking.learning)
    np.testing.assert_array_equal(x[coulomb], 0.0)
    np.testing.assert_array_equal(x[~coulomb], 1.0)
