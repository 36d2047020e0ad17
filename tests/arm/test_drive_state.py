"""Drives that are let go, and gains that change."""

from dataclasses import replace

import numpy as np
import pytest

from arm.drive_state import DriveState, drives_of
from arm.model import Arm, Control, Effect, Friction, Joint, Link
from arm.simulation import simulate
from limbcal.errors import ConfigError, DataError

ROD = Link(1.0, (0.3, 0.0, 0.0), (0.01, 0.1, 0.1, 0.0, 0.0, 0.0))
ARM = Arm(
    "two",
    tuple(Joint(a_m=0.4, friction=Friction(0.2, 0.1), link=ROD) for _ in range(2)),
    gravity_m_s2=(9.81, 0.0, 0.0),
    control=Control("pd", (20.0, 10.0), (-1.0, -0.5)),
)
STEP_S, N = 2e-3, 400
REF = np.tile([0.8, -0.4], (N, 1))
Q0 = np.array([0.3, 0.2])


def state(on=True, kp=None, kv=None):
    def filled(x):
        return None if x is None else np.array(np.broadcast_to(np.asarray(x, dtype=float), (N, 2)))

    return DriveState(filled(on).astype(bool), filled(kp), filled(kv))


def test_gains_of_the_data_overrule_the_law():
    kp, kv = (7.0, 4.0), (-0.3, -0.2)
    own = simulate(replace(ARM, control=Control("pd", kp, kv)), REF, STEP_S, Q0)
    told = simulate(ARM, REF, STEP_S, Q0, drives=state(kp=kp, kv=kv))
    assert np.array_equal(own.q, told.q) and np.array_equal(own.tau, told.tau)
    assert np.array_equal(simulate(ARM, REF, STEP_S, Q0).q, simulate(ARM, REF, STEP_S, Q0, drives=state()).q)


@pytest.mark.parametrize("effects", [(), (Effect("actuator_lag", {"time_constant_s": 0.02}, (1, 2)),)])
def test_a_drive_that_is_let_go_gives_no_torque(effects):
    """The second part falls as an arm falls whose torque is known to be zero, whatever the drive did before."""
    arm = replace(ARM, effects=effects)
    on = np.tile(np.arange(N)[:, None] < N // 2, (1, 2))
    whole = simulate(arm, REF, STEP_S, Q0, drives=state(on))
    middle = whole.q[N // 2], whole.dq[N // 2]
    nothing = np.zeros((N - N // 2, 2))
    fallen = simulate(ARM, nothing, STEP_S, *middle, torque=nothing)
    assert np.array_equal(whole.tau[N // 2 :], nothing)
    assert np.allclose(whole.q[N // 2 :], fallen.q, atol=1e-12)


def test_one_joint_may_be_let_go_alone():
    on = np.tile([True, False], (N, 1))
    free = simulate(ARM, REF, STEP_S, Q0, drives=state(on))
    weak = simulate(replace(ARM, control=Control("pd", (20.0, 0.0), (-1.0, 0.0))), REF, STEP_S, Q0)
    assert np.array_equal(free.q, weak.q)


def test_a_measured_torque_counts_only_where_the_drive_is_engaged():
    torque = np.tile([1.0, 0.5], (N, 1))
    on = np.tile(np.arange(N)[:, None] % 100 < 50, (1, 2))
    motion = simulate(ARM, REF, STEP_S, Q0, torque=torque, drives=state(on))
    assert np.array_equal(motion.tau, np.where(on, torque, 0.0))


def test_torque_by_the_law_is_that_of_the_simulation():
    drives = state(np.tile(np.arange(N)[:, None] > 100, (1, 2)), kp=np.linspace(1.0, 9.0, N)[:, None])
    motion = simulate(ARM, REF, STEP_S, Q0, drives=drives)
    tau = drives.torque(ARM.control, motion.q, motion.dq, motion.ddq, motion.ref)
    assert np.allclose(tau, motion.tau) and not tau[:100].any()


def test_what_does_not_fit_is_said():
    with pytest.raises(ConfigError, match="control.law is 'p'; expected 'pd'"):
        state(kv=-1.0).schedule(Control("p", (1.0, 1.0)))
    with pytest.raises(ConfigError, match="control.kv has 0 numbers"):
        state(kp=1.0).schedule(Control("pd"))
    with pytest.raises(DataError, match="expected the same"):
        simulate(ARM, REF[:-1], STEP_S, Q0, drives=state())
    with pytest.raises(ConfigError, match="paper's scheme"):
        simulate(ARM, REF, STEP_S, Q0, scheme="paper", drives=state())


def test_columns_that_say_nothing_new_are_no_state():
    assert drives_of({"q": np.ones((5, 2))}) is None and drives_of({"on": np.ones((5, 2))}) is None
    assert drives_of({"kp": np.ones((5, 2))}).on.all()


def test_either_gain_or_a_switch_makes_a_state():
    gain = np.full((3, 2), 4.0)
    for role in ("kp", "kv"):
        state = drives_of({"q": gain, role: gain})
        assert state.on.all() and state.on.shape == (3, 2) and getattr(state, role) is gain
        assert getattr(state, {"kp": "kv", "kv": "kp"}[role]) is None
    on = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    state = drives_of({"on": on})
    assert state.on.tolist() == [[True, False], [True, True], [False, True]] and state.kp is state.kv is None
    assert drives_of({"on": np.ones((3, 2)), "kv": gain}).on.all()
    assert not drives_of({"on": np.zeros((3, 2))}).on.any()
