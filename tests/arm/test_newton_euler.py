"""Section 4 against pinocchio on random chains, and against its own closed form for the DD arm."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.kinematics import tip_position
from arm.model import Friction
from arm.newton_euler import bias_torque, forward_dynamics, inverse_dynamics, mass_matrix
from limbcal.errors import DataError
from tests.arm.closeness import close

FEW = settings(max_examples=40, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def without_friction(arm):
    return replace(arm, joints=tuple(replace(joint, friction=Friction()) for joint in arm.joints))


@FEW
@given(SEEDS, st.booleans())
def test_inverse_dynamics_is_pinocchios(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng)
    force, moment = rng.normal(scale=10.0, size=(2, len(q), 3))
    other = peer(arm)
    free = inverse_dynamics(arm, q, dq, ddq)
    pushed = inverse_dynamics(arm, q, dq, ddq, force, moment)
    for k in range(len(q)):
        drag = other.friction(dq[k])
        close(free[k], pin.rnea(other.model, other.data, q[k], dq[k], ddq[k]) + drag)
        load = other.tip_load(q[k], force[k], moment[k])
        close(pushed[k], pin.rnea(other.model, other.data, q[k], dq[k], ddq[k], load) + drag)


@FEW
@given(SEEDS, st.booleans())
def test_mass_matrix_is_pinocchios(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, _, _ = random_motion(arm, rng)
    other = peer(arm)
    M = mass_matrix(arm, q)
    for k in range(len(q)):
        upper = np.triu(pin.crba(other.model, other.data, q[k]))
        close(M[k], upper + np.triu(upper, 1).T)
        assert np.linalg.eigvalsh(M[k])[0] > 0.0


@FEW
@given(SEEDS, st.booleans())
def test_forward_dynamics_is_pinocchios(random_arm, random_motion, peer, seed, branching):
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, tau = random_motion(arm, rng)
    tau = 10.0 * tau
    force, moment = rng.normal(scale=10.0, size=(2, len(q), 3))
    other = peer(arm)
    ddq = forward_dynamics(arm, q, dq, tau, force, moment)
    for k in range(len(q)):
        load = other.tip_load(q[k], force[k], moment[k])
        close(ddq[k], pin.aba(other.model, other.data, q[k], dq[k], tau[k] - other.friction(dq[k]), load))
    close(inverse_dynamics(arm, q, dq, ddq, force, moment), tau)


@FEW
@given(SEEDS, st.booleans())
def test_a_tip_force_does_virtual_work(random_arm, random_motion, seed, branching):
    """What the tip is pushed with shows up as ``-J^T f``, J taken from the kinematics by differences."""
    rng = np.random.default_rng(seed)
    arm = random_arm(rng, branching=branching)
    q, dq, ddq = random_motion(arm, rng, 1)
    force, step = rng.normal(size=3), 1e-5
    difference = inverse_dynamics(arm, q, dq, ddq, tip_force=force) - inverse_dynamics(arm, q, dq, ddq)
    sides = np.vstack([q + step * np.eye(arm.n_joint), q - step * np.eye(arm.n_joint)])
    ahead, behind = np.split(tip_position(arm, sides), 2)
    close(difference[0], -((ahead - behind) / (2 * step)) @ force, 1e-8)


@FEW
@given(SEEDS, st.booleans())
def test_power_is_the_rate_of_energy(random_arm, random_motion, seed, branching):
    """Torque times velocity is what kinetic energy gains, friction and gravity aside."""
    rng = np.random.default_rng(seed)
    arm = replace(without_friction(random_arm(rng, branching=branching)), gravity_m_s2=(0.0, 0.0, 0.0))
    q, dq, ddq = random_motion(arm, rng, 1)
    h = 1e-5

    def energy(t):
        speed = dq + t * ddq
        return 0.5 * float(speed[0] @ mass_matrix(arm, q + t * dq + t * t * ddq / 2)[0] @ speed[0])

    rate = (energy(h) - energy(-h)) / (2 * h)
    np.testing.assert_allclose(inverse_dynamics(arm, q, dq, ddq)[0] @ dq[0], rate, rtol=1e-6, atol=1e-6)


def closed_form(arm, q, dq):
    """Return M, h, D and E of the DD arm as section 4 prints them, h read as ``M_dot dq - ...``."""
    (first, second), (link, L1) = arm.joints, (arm.joints[1].link, arm.joints[0].a_m)
    m2sx, m2sy = link.mass_kg * link.com_m[0], link.mass_kg * link.com_m[1]
    I1, I2 = first.link.inertia_kg_m2[2], link.inertia_kg_m2[2]
    c2, s2 = np.cos(q[1]), np.sin(q[1])
    bend = L1 * (m2sx * c2 - m2sy * s2)
    M = np.array([[I1 + link.mass_kg * L1**2 + I2 + 2 * bend, I2 + bend], [I2 + bend, I2]])
    slope = -L1 * (m2sx * s2 + m2sy * c2)
    M_by_q2 = np.array([[2 * slope, slope], [slope, 0.0]])
    h = M_by_q2 * dq[1] @ dq - 0.5 * np.array([0.0, dq @ M_by_q2 @ dq])
    D = np.diag([first.friction.viscous_N_m_s, second.friction.viscous_N_m_s])
    E = np.array([joint.friction.coulomb_N_m for joint in arm.joints]) * np.sign(dq)
    return M, h, D, E


@FEW
@given(SEEDS)
def test_dd_arm_has_the_closed_form_of_the_paper(dd_arm, random_motion, seed):
    q, dq, ddq = random_motion(dd_arm, np.random.default_rng(seed), 3)
    M, tau = mass_matrix(dd_arm, q), inverse_dynamics(dd_arm, q, dq, ddq)
    bias = bias_torque(dd_arm, q, dq)
    for k in range(len(q)):
        M0, h, D, E = closed_form(dd_arm, q[k], dq[k])
        np.testing.assert_allclose(M[k], M0, rtol=0, atol=1e-12)
        np.testing.assert_allclose(bias[k], h + D @ dq[k] + E, rtol=0, atol=1e-12)
        np.testing.assert_allclose(tau[k], M0 @ ddq[k] + h + D @ dq[k] + E, rtol=0, atol=1e-12)


@FEW
@given(SEEDS)
def test_h_as_printed_would_count_the_inertial_force_twice(dd_arm, random_motion, seed):
    """``d/dt{M dq}`` holds ``M ddq``, which eq. (4) has already: only without it do the torques agree."""
    q, dq, ddq = random_motion(dd_arm, np.random.default_rng(seed), 1)
    M, h, D, E = closed_form(dd_arm, q[0], dq[0])
    printed_h = M @ ddq[0] + h
    wrong = M @ ddq[0] + printed_h + D @ dq[0] + E
    found = inverse_dynamics(dd_arm, q, dq, ddq)[0]
    np.testing.assert_allclose(wrong - found, M @ ddq[0], rtol=0, atol=1e-12)


def steiner(s):
    return s @ s * np.eye(3) - np.outer(s, s)


def recursion_as_printed(arm, q, dq, ddq, *, rho_of_turning=1.0, coriolis_of="omega", at="origin", end="near"):
    """Return the torques by the printed recursion, with a choice where the print slips.

    ``end="far"`` puts frame i where eq. (1) has it and ``p`` is the translation of the whole of eq. (1).
    """
    n, z0 = arm.n_joint, np.array([0.0, 0.0, 1.0])
    w, dw, dv = np.zeros(3), np.zeros(3), -np.array(arm.gravity_m_s2)
    far_end, steps, moving = np.zeros(3), [], []
    for i, joint in enumerate(arm.joints):
        turning = joint.type == "revolute"
        theta = joint.theta_offset_rad + (q[i] if turning else 0.0)
        d = joint.d_m + (0.0 if turning else q[i])
        R = pin.utils.rotate("y", joint.beta_rad) @ pin.utils.rotate("x", joint.alpha_rad)
        p = far_end + R @ [0.0, 0.0, d]
        R = R @ pin.utils.rotate("z", theta)
        if end == "far":
            p = p - far_end + R @ [joint.a_m, 0.0, 0.0]
        steps.append((R, p))
        rho = rho_of_turning if turning else 1.0 - rho_of_turning
        dv = R.T @ (dv + np.cross(dw, p) + np.cross(w, np.cross(w, p)))
        w0, dw0 = R.T @ w, R.T @ dw
        w = w0 + rho * z0 * dq[i]
        dw = dw0 + rho * (z0 * ddq[i] + np.cross(w0, z0 * dq[i]))
        turned = w0 if coriolis_of == "omega" else dw0
        dv = dv + (1 - rho) * (z0 * ddq[i] + 2 * np.cross(turned, z0 * dq[i]))
        moving.append((w, dw, dv))
        far_end = np.array([joint.a_m, 0.0, 0.0])
    f, m, tau = np.zeros(3), np.zeros(3), np.zeros(n)
    for i in reversed(range(n)):
        joint, (w, dw, dv) = arm.joints[i], moving[i]
        mass, s = joint.link.mass_kg, np.array(joint.link.com_m)
        xx, yy, zz, xy, xz, yz = joint.link.inertia_kg_m2
        I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])  # noqa: E741
        if end == "far":
            beyond = s - [joint.a_m, 0.0, 0.0]
            I = I - mass * (steiner(s) - steiner(beyond))  # noqa: E741
            s = beyond
        if at == "centre of mass":
            dv = dv + np.cross(dw, s) + np.cross(w, np.cross(w, s))
        m = I @ dw + np.cross(w, I @ w) + mass * np.cross(s, dv) + m
        f = mass * (dv + np.cross(dw, s) + np.cross(w, np.cross(w, s))) + f
        tau[i] = (m if joint.type == "revolute" else f)[2]
        R, p = steps[i]
        f, m = R @ f, np.cross(p, R @ f) + R @ m
    return tau


@FEW
@given(SEEDS)
def test_the_printed_recursion_holds_with_its_slips_put_right(random_arm, random_motion, seed):
    rng = np.random.default_rng(seed)
    arm = without_friction(random_arm(rng))
    q, dq, ddq = random_motion(arm, rng, 1)
    close(inverse_dynamics(arm, q, dq, ddq)[0], recursion_as_printed(arm, q[0], dq[0], ddq[0]))


@pytest.mark.parametrize(
    "slip",
    [{"rho_of_turning": 0.0}, {"coriolis_of": "omega_dot"}, {"at": "centre of mass"}, {"end": "far"}],
    ids=str,
)
def test_each_slip_of_the_printed_recursion_contradicts_pinocchio(random_arm, random_motion, peer, slip):
    rng = np.random.default_rng(7)
    arm = without_friction(random_arm(rng, 5))
    assert {joint.type for joint in arm.joints} == {"revolute", "prismatic"}
    q, dq, ddq = (rows[0] for rows in random_motion(arm, rng, 1))
    other = peer(arm)
    true = pin.rnea(other.model, other.data, q, dq, ddq)
    close(recursion_as_printed(arm, q, dq, ddq), true)
    assert np.abs(recursion_as_printed(arm, q, dq, ddq, **slip) - true).max() > 1e-2


def test_a_joint_at_rest_shows_no_coulomb_friction(dd_arm):
    still = np.zeros((1, 2))
    np.testing.assert_array_equal(inverse_dynamics(dd_arm, still, still, still), 0.0)


def test_gravity_pulls_a_hanging_arm_as_a_lever(vertical_arm):
    """Stretched out level, each joint carries weight times lever arm."""
    first, second = (joint.link for joint in vertical_arm.joints)
    g, still = 9.80665, np.zeros((1, 2))
    elbow = second.mass_kg * g * second.com_m[0]
    shoulder = first.mass_kg * g * first.com_m[0] + second.mass_kg * g * (0.25 + second.com_m[0])
    np.testing.assert_allclose(bias_torque(vertical_arm, still, still)[0], [shoulder, elbow], rtol=1e-14)


def test_a_tip_load_may_be_one_for_all_samples(dd_arm):
    q = np.random.default_rng(0).normal(size=(4, 2))
    force, moment = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    one = inverse_dynamics(dd_arm, q, q, q, force, moment)
    each = inverse_dynamics(dd_arm, q, q, q, np.tile(force, (4, 1)), np.tile(moment, (4, 1)))
    np.testing.assert_array_equal(one, each)


def test_wrong_shapes_are_named(dd_arm):
    q = np.zeros((4, 2))
    with pytest.raises(DataError, match=r"ddq has shape \(4, 3\), expected \(n_sample, 2\)"):
        inverse_dynamics(dd_arm, q, q, np.zeros((4, 3)))
    with pytest.raises(DataError, match=r"tip_force has shape \(2, 3\), expected \(4, 3\)"):
        inverse_dynamics(dd_arm, q, q, q, tip_force=np.zeros((2, 3)))
    with pytest.raises(DataError, match=r"tip_moment has shape \(4,\), expected \(4, 3\)"):
        forward_dynamics(dd_arm, q, q, q, tip_moment=np.zeros(4))
    with pytest.raises(DataError, match="tau has shape"):
        forward_dynamics(dd_arm, q, q, np.zeros((4, 1)))


def test_samples_that_do_not_match_are_named(dd_arm):
    with pytest.raises(DataError, match="dq has 3 samples and q has 4; expected as many"):
        inverse_dynamics(dd_arm, np.zeros((4, 2)), np.zeros((3, 2)), np.zeros((4, 2)))
    with pytest.raises(DataError, match="tau has 1 samples and q has 4; expected as many"):
        forward_dynamics(dd_arm, np.zeros((4, 2)), np.zeros((4, 2)), np.zeros(2))
