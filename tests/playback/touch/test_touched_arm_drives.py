"""What drives a touched arm: its own law, one that holds it, or nothing; and the account of its energy."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.control import gains
from arm.model import Arm, Control, Friction
from arm.newton_euler import mass_matrix
from playback.touch.grip import Hand
from playback.touch.limit import Coupling
from playback.touch.touched_arm import TouchedArm

STEP_S = 1e-3
Q0 = np.array([0.4, -0.9])
PDA = Control("pda", (400.0, 300.0), (-60.0, -40.0), (-0.3, -0.2))


def level(control: Control) -> Arm:
    """Return an arm of two joints that nothing slows down, and on whose joints no weight acts."""
    arm = load_arm("dd-arm")
    joints = tuple(replace(joint, friction=Friction()) for joint in arm.joints)
    return replace(arm, joints=joints, control=control)


def stiffest(arm: TouchedArm) -> float:
    """Return the stiffness that a hand is given that asked for any."""
    x = arm.touched_point(arm.tip)
    arm.take(arm.tip, Hand(x))
    arm.step(1, Hand(x))
    return float(arm.given.stiffness)


def test_an_acceleration_that_is_fed_back_counts_as_inertia_while_it_is() -> None:
    arm = TouchedArm(level(PDA), Q0, STEP_S, Coupling(1e9, 1.0, 1e9))
    s1, c1 = np.sin(Q0[0]), np.cos(Q0[0])
    s12, c12 = np.sin(Q0.sum()), np.cos(Q0.sum())
    J = np.array([[-0.25 * s1 - 0.3 * s12, -0.3 * s12], [0.25 * c1 + 0.3 * c12, 0.3 * c12]])
    M = mass_matrix(level(PDA), Q0)[0]
    held, free = (
        1.0 / np.linalg.eigvalsh(J @ np.linalg.inv(inertia) @ J.T)[-1] / STEP_S**2
        for inertia in (M + np.diag([0.3, 0.2]), M)
    )
    assert stiffest(arm) == pytest.approx(held)
    arm.reset(Q0)
    arm.free()
    assert stiffest(arm) == pytest.approx(free)
    arm.hold(Q0)
    assert stiffest(arm) == pytest.approx(held)
    measured = TouchedArm(level(Control()), Q0, STEP_S, Coupling(1e9, 1.0, 1e9))
    assert stiffest(measured) == pytest.approx(free)
    measured.hold()
    assert stiffest(measured) == pytest.approx(free)


@pytest.mark.parametrize("control", [Control(), PDA], ids=["measured", "pda"])
def test_nothing_drives_an_arm_that_is_free(control: Control) -> None:
    arm = TouchedArm(level(control), Q0, STEP_S, Coupling())
    arm.hold(Q0 + 1.0)
    arm.free()
    arm.step(100)
    np.testing.assert_array_equal(arm.state, [Q0, [0.0, 0.0], [0.0, 0.0]])
    arm.hold(Q0 + 1.0)
    arm.step(100)
    assert np.all(arm.state[1] > 0.1)
    arm.reset(Q0)
    arm.step(100)
    np.testing.assert_array_equal(arm.state, [Q0, [0.0, 0.0], [0.0, 0.0]])


def test_its_own_law_starts_as_the_equations_say() -> None:
    """From rest, ``(M - ka) ddq = kp e``."""
    arm = TouchedArm(level(PDA), Q0, 1e-7, Coupling())
    arm.hold(Q0 + [0.1, -0.2])
    arm.step(1)
    kp, _, ka = gains(PDA, 2)
    M = mass_matrix(level(PDA), Q0)[0] - np.diag(ka)
    np.testing.assert_allclose(arm.state[2], np.linalg.solve(M, kp * [0.1, -0.2]), rtol=1e-4)


@pytest.mark.parametrize(
    ("account", "dissipated", "passive"),
    [  # hand, arm, injected, device, stored, braked: by hand
        ([3.0, 1.0, 0.5, 0.25, 0.75, 2.0], 1.75, True),
        ([1.0, 3.0, 0.0, 1.5, 0.5, 0.0], -2.5, False),
        ([1.0, 3.0, 0.0, 2.5, 0.5, 0.0], -2.5, True),
        ([0.0, 0.0, 0.0, -0.9e-9, 0.0, 0.0], 0.0, True),  # rounding
        ([0.0, 0.0, 0.0, -1.1e-9, 0.0, 0.0], 0.0, False),
        ([1e9, 1e9 + 1.5, 0.0, 0.0, 0.0, 0.0], -1.5, True),  # of much that went to and fro, more is
        ([-1e9, -1e9 + 1.5, 0.0, 0.0, 0.0, 0.0], -1.5, True),
        ([1e9, 1e9 + 2.5, 0.0, 0.0, 0.0, 0.0], -2.5, False),
    ],
)
def test_no_more_comes_out_than_went_in(account: list[float], dissipated: float, passive: bool) -> None:
    arm = TouchedArm(level(PDA), Q0, STEP_S, Coupling())
    assert arm.energy() == {
        **dict.fromkeys(("hand", "arm", "injected", "stored", "dissipated", "device"), 0.0),
        **{"braked_ticks": 0, "passive": True},
    }
    arm._touch.account[:] = account
    hand, out, injected, device, stored, braked = account
    assert arm.energy() == {
        **{"hand": hand, "arm": out, "injected": injected, "stored": stored, "device": device},
        **{"dissipated": dissipated, "braked_ticks": int(braked), "passive": passive},
    }
