"""A trial as a file has it, simulated."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control, Effect
from arm.simulation import GearedMotion, simulate
from arm.trial_simulation import simulate_trial

ARM = load_arm("dd-arm")
REST = np.zeros(2)
STEP_S, FINER = 0.05, 50
REF = np.outer(np.arange(20) > 3, [0.4, -0.2])


def test_coarse_targets_are_held_while_the_arm_goes_in_fine_steps() -> None:
    stiff = replace(ARM, control=Control("pd", (400.0, 400.0), (-120.0, -60.0)))
    fine = simulate(stiff, np.repeat(REF, FINER, axis=0), STEP_S / FINER, REST)
    motion = simulate_trial(stiff, {"ref": REF}, STEP_S, REST)
    np.testing.assert_array_equal(motion.q, fine.q[::FINER])
    np.testing.assert_array_equal(motion.t, fine.t[::FINER])
    assert np.abs(simulate(stiff, REF, STEP_S, REST).q - motion.q).max() > 1e-3  # steps of 50 ms lead elsewhere


def test_torque_goes_straight_from_sample_to_sample() -> None:
    free = replace(ARM, control=Control("measured"))
    tau = np.column_stack([np.linspace(0.0, 1.0, 20), np.zeros(20)])
    motion = simulate_trial(free, {"tau": tau}, STEP_S, REST)
    t = np.arange(20 * FINER) * STEP_S / FINER
    line = np.column_stack([np.minimum(t / (19 * STEP_S), 1.0), 0.0 * t])
    fine = simulate(free, 0.0 * line, STEP_S / FINER, REST, torque=line)
    np.testing.assert_allclose(motion.q, fine.q[::FINER], atol=1e-9)


def test_a_trials_own_gains_and_speed_count() -> None:
    columns = {"ref": REF, "kp": np.full((20, 2), 20.0), "kv": np.full((20, 2), -5.0), "dq": np.full((20, 2), 0.3)}
    own = replace(ARM, control=Control("pd", (20.0, 20.0), (-5.0, -5.0)))
    known = simulate(own, np.repeat(REF, FINER, axis=0), STEP_S / FINER, REST, np.array([0.3, 0.3]))
    np.testing.assert_allclose(simulate_trial(ARM, columns, STEP_S, REST).q, known.q[::FINER], atol=1e-12)


@pytest.mark.parametrize("scheme", ["rk4", "paper"])
def test_the_scheme_is_passed_on(scheme) -> None:
    known = simulate(ARM, REF, 1e-3, REST, scheme=scheme)
    np.testing.assert_array_equal(simulate_trial(ARM, {"ref": REF}, 1e-3, REST, scheme).q, known.q)


def test_motors_and_links_stay_apart() -> None:
    spring = Effect("joint_elasticity", {"stiffness_N_m_rad": 20.0, "damping_N_m_s": 0.5}, (2,))
    motion = simulate_trial(replace(ARM, effects=(spring,)), {"ref": REF}, STEP_S, REST)
    assert isinstance(motion, GearedMotion)
    assert motion.link_q.shape == motion.q.shape == REF.shape
    assert np.abs(motion.link_q - motion.q).max() > 1e-3
