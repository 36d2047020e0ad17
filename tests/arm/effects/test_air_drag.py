"""Air drag against the plane's angles: it resists a link's own turning, and every joint before it feels it."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.effects.effect_table import changed
from arm.model import Effect
from arm.newton_euler import forward_dynamics, inverse_dynamics, mass_matrix

ARM = load_arm("dd-arm")


def having(*drags: tuple[int, float]):
    effects = tuple(Effect("air_drag", {"drag_N_m_s2": c}, joints=(j,)) for j, c in drags)
    return replace(ARM, effects=effects)


def test_in_a_plane_it_goes_by_the_square_of_the_links_own_speed():
    q, dq, ddq = np.random.default_rng(0).uniform(-2.0, 2.0, (3, 50, 2))
    c1, c2 = 0.3, 0.07
    torque = inverse_dynamics(changed(having((1, c1), (2, c2))), q, dq, ddq) - inverse_dynamics(ARM, q, dq, ddq)
    first, second = dq[:, 0], dq.sum(axis=1)
    on_second = c2 * second * np.abs(second)
    np.testing.assert_allclose(torque[:, 1], on_second, atol=1e-12)
    np.testing.assert_allclose(torque[:, 0], c1 * first * np.abs(first) + on_second, atol=1e-12)


def test_a_link_that_stays_level_feels_none_though_its_joint_turns():
    dq = np.array([[1.3, -1.3]])
    at = np.zeros_like(dq)
    torque = inverse_dynamics(changed(having((2, 0.5))), at, dq, at) - inverse_dynamics(ARM, at, dq, at)
    np.testing.assert_allclose(torque, 0.0, atol=1e-12)


def test_it_is_no_part_of_the_mass_matrix_and_only_takes_power():
    arm, rng = changed(having((1, 0.2), (2, 0.4))), np.random.default_rng(1)
    q, dq = rng.uniform(-2.0, 2.0, (2, 30, 2))
    np.testing.assert_array_equal(mass_matrix(arm, q), mass_matrix(ARM, q))
    drag = inverse_dynamics(arm, q, dq, 0 * q) - inverse_dynamics(ARM, q, dq, 0 * q)
    assert np.all(np.sum(drag * dq, axis=1) > 0.0)
    tau = rng.uniform(-1.0, 1.0, (30, 2))
    found = inverse_dynamics(arm, q, dq, forward_dynamics(arm, q, dq, tau))
    np.testing.assert_allclose(found, tau, atol=1e-9)


def test_a_link_may_have_it_in_its_file():
    text = format_arm(ARM).replace("inertia_kg_m2 = [", "air_drag_N_m_s2 = 0.25, inertia_kg_m2 = [", 1)
    arm = parse_arm(text, "it")
    assert [joint.link.air_drag_N_m_s2 for joint in arm.joints] == [0.25, None]
    assert parse_arm(format_arm(arm), "it") == arm
    more = changed(replace(arm, effects=having((1, 0.5)).effects))
    assert more.joints[0].link.air_drag_N_m_s2 == pytest.approx(0.75)
