"""A geared rotor that turns with the joint."""

import numpy as np

from arm.newton_euler import mass_matrix
from arm.simulation import simulate


def test_a_rotor_is_a_mass_on_the_diagonal(arm, having):
    having_rotor = having(arm, "rotor_inertia", inertia_kg_m2=0.4)
    ref = np.tile([1.0, -0.8, 0.5], (2, 1))
    plain, geared = (simulate(each, ref, 1e-3, np.full(3, 0.2)) for each in (arm, having_rotor))
    M = mass_matrix(arm, plain.q[:1])[0]
    np.testing.assert_allclose((M + np.diag([0.4, 0.0, 0.0])) @ geared.ddq[0], M @ plain.ddq[0], rtol=0, atol=1e-9)


def test_a_wheel_with_a_rotor_is_heavier_to_turn(wheel, having):
    pull = np.full((100, 1), 0.9)
    motion = simulate(having(wheel, "rotor_inertia", inertia_kg_m2=0.4), pull, 1e-2, np.zeros(1), torque=pull)
    np.testing.assert_allclose(motion.dq[:, 0], motion.t, rtol=1e-12, atol=1e-15)  # 0.9 N m on 0.9 kg m^2


def test_it_only_adds(ranges):
    ranges("rotor_inertia", "inertia_kg_m2", 0.0, 1e3)
