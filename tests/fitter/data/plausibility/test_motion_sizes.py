"""How far and fast joints move, against motions whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.control import control_torque
from arm.model import Arm, Control, Joint
from arm.regressor import regressor
from fitter.data.motions import Measured
from fitter.data.plausibility.motion_sizes import (
    continuous,
    drawn_torque,
    path_lengths,
    rate_ratio,
    reach,
    thinned,
    torque_residual,
    turning,
)
from tests.fitter.data.plausibility.conftest import changed

DEGREE = np.pi / 180.0


def motion_of(t: np.ndarray, **columns: np.ndarray) -> Measured:
    return Measured("m", "m.csv", 0, t, columns)


def test_joints_that_slide_do_not_turn() -> None:
    arm = Arm("two", (Joint("prismatic"), Joint(a_m=0.3)))
    assert turning(arm).tolist() == [False, True]


@pytest.mark.parametrize(("correlation", "moves_on"), [(0.0, False), (0.4, False), (0.6, True), (0.99, True)])
def test_neighbours_tell_a_motion_from_poses(correlation: float, moves_on: bool) -> None:
    """Von Neumann's ratio of an autoregression is one minus its correlation."""
    rng, q = np.random.default_rng(0), np.zeros(20_000)
    push = rng.normal(size=len(q))
    for k in range(1, len(q)):
        q[k] = correlation * q[k - 1] + push[k]
    assert continuous(q[:, None]) == moves_on


def test_one_joint_that_moves_on_is_enough() -> None:
    t, rng = np.linspace(0.0, 3.0, 500), np.random.default_rng(1)
    jumps, smooth, still = rng.normal(size=t.size), np.sin(t), np.zeros(t.size)
    assert continuous(np.column_stack([jumps, smooth]))
    assert not continuous(np.column_stack([jumps, still]))
    assert continuous(np.column_stack([still, still]))


@pytest.mark.parametrize(("rows", "moves_on"), [(2, False), (3, True)])
def test_two_samples_are_no_motion(rows: int, moves_on: bool) -> None:
    assert continuous(np.zeros((rows, 1))) == moves_on


def test_a_path_is_as_long_as_it_goes_to_and_fro() -> None:
    t, rng = np.linspace(0.0, 1.0, 40_000, endpoint=False), np.random.default_rng(2)
    values = np.column_stack([0.3 * np.sin(6.0 * np.pi * t), 2.0 * t]) + 1e-3 * rng.normal(size=(len(t), 2))
    assert path_lengths(values) == pytest.approx([4.0 * 3 * 0.3, 2.0], rel=0.06)


@pytest.mark.parametrize(("rows", "block"), [(7, 1), (400, 1), (799, 1), (800, 2), (1001, 2), (4000, 10)])
def test_neighbours_are_averaged(rows: int, block: int) -> None:
    values = np.arange(2.0 * rows).reshape(rows, 2)
    found = thinned(values)
    assert found.shape == (rows // block, 2)
    assert found[0] == pytest.approx(values[:block].mean(axis=0))
    assert found[-1] == pytest.approx(values[block * (rows // block - 1) : block * (rows // block)].mean(axis=0))


def test_a_velocity_is_compared_with_its_angle_s_slope() -> None:
    t = np.arange(0.0, 3.0, 0.004)
    rng = np.random.default_rng(3)
    q = np.column_stack([np.sin(t), np.cos(2.0 * t), np.sin(t), np.full(len(t), 0.3)])
    dq = np.column_stack([np.cos(t), -2.0 * np.sin(2.0 * t) / DEGREE, rng.normal(size=len(t)), np.cos(t)])
    found = rate_ratio(motion_of(t, q=q, dq=dq), "q", "dq")
    assert found is not None
    assert found[:2] == pytest.approx([1.0, 1.0 / DEGREE], rel=1e-4)
    assert np.isnan(found[2:]).all()


def test_without_a_velocity_or_with_two_rows_nothing_is_compared() -> None:
    t = np.arange(0.0, 3.0, 0.1)
    q = np.sin(t)[:, None]
    assert rate_ratio(motion_of(t, q=q), "q", "dq") is None
    assert rate_ratio(motion_of(t[:2], q=q[:2], dq=q[:2]), "q", "dq") is None
    three = motion_of(t[:3], q=q[:3], dq=np.gradient(q[:3], 0.1, axis=0))
    assert rate_ratio(three, "q", "dq") == pytest.approx([1.0])


def test_the_right_unit_explains_the_torque(arm: Arm, clean) -> None:
    motion = clean(1)
    right = torque_residual(arm, motion, np.ones(2))
    wrong = torque_residual(arm, motion, np.array([1.0, DEGREE]))
    assert right is not None and wrong is not None
    assert np.all(right < 2e-3) and np.all(right > 0.0)
    assert wrong.max() > 0.05


def test_a_wrist_s_torque_is_heard_beside_a_shoulder_s(arm: Arm, clean) -> None:
    """A motion in other units of torque, joint by joint, leaves the same share."""
    motion = clean(2)
    wrong = np.array([DEGREE, 1.0])
    left = torque_residual(arm, motion, wrong)
    less = torque_residual(arm, changed(motion, tau=1e-3 * motion.columns["tau"]), wrong)
    assert left == pytest.approx(less, rel=1e-6)


def test_a_joint_without_torque_is_not_judged(arm: Arm, clean) -> None:
    motion = clean(0)
    tau = motion.columns["tau"] * [1.0, 0.0]
    left = torque_residual(arm, changed(motion, tau=tau), np.ones(2))
    assert left is not None and left[0] < 0.01 and np.isnan(left[1])
    assert torque_residual(arm, changed(motion, tau=0.0 * tau), np.ones(2)) is None


def test_without_torque_or_target_there_is_nothing_to_explain(arm: Arm, clean) -> None:
    motion = clean(0)
    bare = motion_of(motion.t, q=motion.columns["q"])
    driven = replace(arm, control=load_arm("dd-arm").control)
    assert torque_residual(arm, bare, np.ones(2)) is None
    assert torque_residual(driven, bare, np.ones(2)) is None
    assert torque_residual(driven, motion, np.ones(2)) is None  # its torque is not the law's
    short = {name: values[:7] for name, values in motion.columns.items()}
    assert drawn_torque(arm, motion_of(motion.t[:7], **short), np.ones(2)) is None
    enough = {name: values[:8] for name, values in motion.columns.items()}
    assert drawn_torque(arm, motion_of(motion.t[:8], **enough), np.ones(2)) is not None


def test_the_law_s_torque_is_drawn_from_target_and_angle() -> None:
    arm = replace(load_arm("dd-arm"), control=Control("pd", (9.0, 8.0), (-2.0, -1.0)))
    t = np.arange(0.0, 2.0, 0.01)
    q, ref = np.column_stack([np.sin(t), 0.5 * t]), np.column_stack([np.cos(t), 0.1 * t])
    scale = np.array([1.0, DEGREE])
    drawn = drawn_torque(arm, motion_of(t, q=q, ref=ref), scale)
    assert drawn is not None
    dq = np.column_stack([np.cos(t), np.full(len(t), 0.5 * DEGREE)])
    expected = np.array([9.0, 8.0]) * scale * (ref - q) + np.array([-2.0, -1.0]) * dq
    assert drawn[1][1:-1] == pytest.approx(expected[1:-1], abs=1e-3)
    inner = slice(2, -2)
    ddq = np.column_stack([-np.sin(t), np.zeros(len(t))])
    assert drawn[0][inner] == pytest.approx(regressor(arm, scale * q, dq, ddq)[inner], abs=2e-3)
    switched = motion_of(t, q=q, ref=ref, kp=np.full((len(t), 2), 3.0))
    less = drawn_torque(arm, switched, np.ones(2))
    assert less is not None
    exact = control_torque(Control("pd", (3.0, 3.0), (-2.0, -1.0)), q, np.gradient(q, t, axis=0), q * 0.0, ref)
    assert less[1] == pytest.approx(exact, abs=1e-9)


def test_an_arm_reaches_as_far_as_its_lengths() -> None:
    arm = Arm("bent", (Joint(a_m=0.3, d_m=0.4), Joint(a_m=0.2), Joint("prismatic", d_m=-0.1)))
    assert reach(arm) == pytest.approx(0.5 + 0.2 + 0.1)
    assert reach(Arm("none", (Joint(),))) == 0.0


def test_a_joint_that_stands_has_no_speed_to_compare() -> None:
    t = np.arange(0.0, 1.0, 0.1)
    still = np.column_stack([np.ones(10), t])
    found = rate_ratio(motion_of(t, q=still, dq=np.column_stack([np.zeros(10), 3.0 * np.ones(10)])), "q", "dq")
    assert found is not None
    assert np.isnan(found[0]) and found[1] == pytest.approx(3.0)
