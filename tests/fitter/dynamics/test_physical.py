"""What no arm can have is named, and the best that one can have is found."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.model import Control, Friction, Link
from arm.physical_links import is_possible, link_parameters, pseudo_inertia
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.trial import Trial
from fitter.dynamics.physical import nearest_possible, physical_optimum, violations
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.torque_sums import add_up
from fitter.regression_sums.trial_sums import trial_sums

ARM = load_arm("dd-arm")
BASE = structural_parameters(ARM)
TRUE = BASE.combination @ standard_parameters(ARM)
INDEX = {name: k for k, name in enumerate(BASE.names)}


def moved(arm):
    return list(motions(arm, replace(Bench(), rate_hz=200.0, learning=3, evaluating=0, simulation_hz=1000.0), 1))


def problem_of(arm, noise, seed=0, held=None):
    rng, base = np.random.default_rng(seed), structural_parameters(arm)
    measured = replace(arm, control=Control())
    trials = [
        Trial("m", m.t, 0.005, m.q, m.dq, m.ddq, m.tau + noise * rng.normal(size=m.q.shape), m.ref)
        for m in moved(arm)
    ]
    sums = add_up([trial_sums(measured, base, trial) for trial in trials])
    return base, torque_problem(sums, base.combination @ standard_parameters(arm), held)


def possible(arm):
    rows = standard_parameters(arm)[: 10 * arm.n_joint].reshape(-1, 10)
    return all(is_possible(row) for row in rows)


def braking(arm):
    joints = [
        replace(j, friction=Friction(abs(j.friction.viscous_N_m_s) + 0.05, abs(j.friction.coulomb_N_m) + 0.05))
        for j in arm.joints
    ]
    return replace(arm, joints=tuple(joints))


def test_the_papers_own_friction_pushes():
    found = violations(ARM, BASE, TRUE)
    assert [v.name for v in found] == ["D1", "fc2"]
    assert found[0].sentence.startswith("D1 = -0.002409 N m s/rad pushes instead of braking")
    assert found[0].nearest == 0.0
    assert found[0].std_away is None and not found[0].within_error


def test_standard_errors_say_how_bad_it_is():
    exact, vague = (violations(ARM, BASE, TRUE, np.eye(8) * std**2) for std in (1e-4, 0.01))
    assert [v.name for v in exact] == ["D1", "fc2"]
    assert exact[0].std_away == pytest.approx(24.09)
    assert "24.1 standard errors away" in exact[0].sentence
    assert all(v.within_error for v in vague)
    assert "within its error" in vague[0].sentence


@pytest.mark.parametrize("share", [0.5, 0.9, 0.999, 1.001, 1.1, 10.0])
def test_inertia_too_small_for_its_first_moments(share):
    """A flat two-joint arm can exist if I2 (I1+m2 L1^2) / L1^2 exceeds the square of m2 s2."""
    values = np.abs(TRUE)
    least = (values[1] ** 2 + values[2] ** 2) * ARM.joints[0].a_m ** 2 / values[0]
    values[INDEX["I2"]] = share * least
    found = violations(ARM, BASE, values)
    assert bool(found) == (share < 1.0)
    # with an error of one parameter alone, it is the one that must move, to its bound
    std = np.full(8, 1e-3 * least)
    std[INDEX["I2"]] = least
    found = violations(ARM, BASE, values, np.diag(std**2))
    assert bool(found) == (share < 0.95)
    if found:
        assert found[0].name == "I2"
        assert found[0].nearest == pytest.approx(least, rel=0.02)
        assert found[0].std_away == pytest.approx(1.0 - share, rel=0.02, abs=1e-3)
        assert found[0].within_error


def test_what_was_not_learnt_accuses_nobody():
    values, covariance = np.abs(TRUE), np.eye(8) * 1e-6
    values[INDEX["I2"]] = 0.0
    assert violations(ARM, BASE, values, covariance)
    covariance[INDEX["I2"], INDEX["I2"]] = np.nan
    assert not violations(ARM, BASE, values, covariance)


@pytest.mark.parametrize("name", ["dd-arm", "dd-arm-vertical", "spatial-arm"])
def test_exact_data_of_a_possible_arm_gives_that_arm(name):
    arm = braking(load_arm(name))
    base, problem = problem_of(arm, 0.0)
    blank = replace(arm, joints=tuple(replace(j, link=Link()) for j in arm.joints))
    genes, found = physical_optimum(blank, base, problem)
    assert possible(found)
    scale = 1.0 / np.linalg.norm(problem.W, axis=0)
    assert np.allclose(genes, problem.optimum(), rtol=1e-5, atol=1e-4 * scale.max())
    assert np.allclose(base.combination @ standard_parameters(found), problem.complete(genes), atol=1e-6)


@pytest.mark.parametrize("name", ["dd-arm", "dd-arm-vertical", "spatial-arm"])
def test_noise_drives_the_plain_answer_out_and_the_possible_one_stays(name):
    arm = braking(load_arm(name))
    base, problem = problem_of(arm, 3.0)
    plain = problem.optimum()
    assert violations(arm, base, problem.complete(plain))
    genes, found = physical_optimum(arm, base, problem)
    assert possible(found)
    assert not violations(found, base, base.combination @ standard_parameters(found))
    friction = [(j.friction.viscous_N_m_s, j.friction.coulomb_N_m) for j in found.joints]
    assert np.min(friction) >= 0.0
    # never better than without the constraint, never worse than the true arm, which is possible
    true = base.combination @ standard_parameters(arm)
    costs = [float(problem.cost(x[None])[0]) for x in (plain, genes, true[problem.free])]
    assert costs[0] < costs[1] < costs[2]
    assert np.array_equal(genes, physical_optimum(arm, base, problem)[0])


def test_frictions_at_their_bound_are_zero():
    base, problem = problem_of(ARM, 0.0)
    genes, found = physical_optimum(ARM, base, problem)
    assert found.joints[0].friction.viscous_N_m_s == 0.0
    assert found.joints[1].friction.coulomb_N_m == 0.0
    lower = np.where(np.arange(8) < 4, -np.inf, 0.0)  # the inertia is possible by far
    plain = scipy.optimize.lsq_linear(problem.W, problem.z, (lower, np.full(8, np.inf)), tol=1e-14).x
    assert np.allclose(genes, plain, rtol=1e-4, atol=1e-6)


def test_what_is_held_stays_even_where_it_pushes():
    held = {INDEX["D1"]: -0.002409, INDEX["I2"]: 0.5}
    base, problem = problem_of(ARM, 0.1, held=held)
    found = physical_optimum(ARM, base, problem)[1]
    values = base.combination @ standard_parameters(found)
    assert values[INDEX["D1"]] == -0.002409
    assert values[INDEX["I2"]] == pytest.approx(0.5, rel=1e-5)
    assert possible(found)


def test_a_joint_that_did_not_move_keeps_its_links_where_it_can():
    """Joint 1 at rest: its own inertia is not identified, and the arm's own is as good as any."""
    base = structural_parameters(ARM)
    m = moved(ARM)[0]
    still = [np.column_stack([0.0 * x[:, 0], x[:, 1]]) for x in (m.q, m.dq, m.ddq)]
    tau = m.tau + 0.2 * np.random.default_rng(0).normal(size=m.tau.shape)
    sums = trial_sums(replace(ARM, control=Control()), base, Trial("m", m.t, 0.005, *still, tau))
    problem = torque_problem(sums, TRUE)
    assert INDEX["I1+m2*L1^2"] not in problem.free
    genes, found = physical_optimum(ARM, base, problem)
    values = base.combination @ standard_parameters(found)
    assert possible(found)
    assert values[0] == pytest.approx(TRUE[0], rel=1e-2)
    assert np.allclose(problem.W @ genes, problem.W @ values[problem.free], atol=1e-6)


def test_the_nearest_possible_arm_keeps_what_is_possible_and_has_no_negative_inertia():
    arm = braking(load_arm("dd-arm-vertical"))
    base = structural_parameters(arm)
    true = base.combination @ standard_parameters(arm)
    near = nearest_possible(arm, base, true)
    np.testing.assert_allclose(base.combination @ standard_parameters(near), true, rtol=1e-4, atol=1e-6)
    turned = nearest_possible(arm, base, -true)
    for joint in turned.joints:  # next to no mass at all, as far as rounding lets it be seen
        assert np.linalg.eigvalsh(pseudo_inertia(link_parameters(joint.link)))[0] > -1e-9
        assert min(joint.link.inertia_kg_m2[:3]) >= 0.0 and joint.link.mass_kg >= 0.0
    assert all(joint.friction == Friction(0.0, 0.0, joint.friction.static_N_m) for joint in turned.joints)


def test_what_is_not_known_does_not_count():
    arm = braking(load_arm("dd-arm-vertical"))
    base = structural_parameters(arm)
    true = base.combination @ standard_parameters(arm)
    unknown = np.where(np.arange(len(true)) == 0, np.nan, true)
    near = nearest_possible(arm, base, unknown)
    found = base.combination @ standard_parameters(near)
    assert possible(near)
    np.testing.assert_allclose(found[1:], true[1:], rtol=1e-3, atol=1e-6)
