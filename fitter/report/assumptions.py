"""What a calibration took for granted, and what a mistake in it would scale."""

from collections.abc import Sequence

import numpy as np

from arm.model import Arm
from limbcal.digits import plain

_LAWS = {
    "pd": "tau = kp (ref - q) + kv dq, eq. (5)",
    "pda": "tau = kp (ref - q) + kv dq + ka ddq, eq. (6)",
    "p": "tau = kp (ref - q), eq. (7)",
}


def dynamics_assumptions(arm: Arm, *, lengths_learnt: bool, targets_found: bool, driven: bool = True) -> list[str]:
    """Return what a fit of the dynamics took for granted, a sentence each.

    Parameters
    ----------
    arm : Arm
        The arm that was calibrated.
    lengths_learnt : bool
        Whether its lengths were learnt from the same motion, and not taken from the arm file.
    targets_found : bool
        Whether the controller's targets were found with the arm, and not recorded.
    driven : bool
        Whether anything drove the joints.
    """
    return [
        _torque(arm) if driven else _UNDRIVEN,
        *([_TARGETS] if targets_found else []),
        _gravity(arm),
        _lengths(arm, lengths_learnt),
        "Links are rigid, and friction is viscous plus Coulomb (and static, where F is given).",
    ]


def kinematics_assumptions(arm: Arm) -> list[str]:
    """Return what a fit of the geometry took for granted, a sentence each."""
    turning = ", ".join(
        f"{k} {'turns' if joint.type == 'revolute' else 'slides'}" for k, joint in enumerate(arm.joints, 1)
    )
    sensors = [
        f"{sensor.name} on link {sensor.joint} at ({', '.join(plain(x, 3) for x in sensor.position_m)}) m"
        for sensor in arm.sensors
    ]
    sentences = [f"How joints move is taken from the arm file: {turning}."]
    if sensors:
        sentences.append(
            f"Where sensors sit is taken from the arm file: {'; '.join(sensors)}. Lengths scale with the "
            "distances between the sensors of a link: 1 % off there is 1 % off in the lengths."
        )
    return sentences


_UNDRIVEN = (
    "No torque was measured: nothing drove the joints. Motion alone then tells ratios, and every inertia, moment "
    "and friction scales with the one that was given."
)
_TARGETS = (
    "The controller's targets were not recorded: each motion is taken to go to one constant target, which was "
    "found together with the arm."
)


def _torque(arm: Arm) -> str:
    control = arm.control
    if control.law == "measured":
        return (
            "Torque was measured. Every inertia, moment and friction scales with it: a torque that reads 1 % too "
            "much makes each of them 1 % too large."
        )
    gains = "; ".join(
        f"{name} = {_listed(values)}"
        for name in ("kp", "kv", "ka")
        if (values := getattr(control, name)) and f"{name} " in _LAWS[control.law]
    )
    return (
        f"No torque was measured: it is that of the control law {_LAWS[control.law]}, with {gains} "
        "(N m a rad, a rad/s, a rad/s²) from the arm file. Every inertia, moment and friction scales with these "
        "gains: gains twice as large make each of them twice as large, and motion cannot tell."
    )


def _gravity(arm: Arm) -> str:
    size = float(np.linalg.norm(arm.gravity_m_s2))
    if size == 0.0:
        return "There is no gravity, as the arm file says."
    return f"Gravity is ({_listed(arm.gravity_m_s2)}) m/s² in the base frame, from the arm file."


def _lengths(arm: Arm, learnt: bool) -> str:
    lengths = ", ".join(f"a{k} = {plain(joint.a_m)} m" for k, joint in enumerate(arm.joints, 1))
    if learnt:
        return f"Lengths are those learnt from the same motion ({lengths})."
    return (
        f"Lengths are taken from the arm file ({lengths}), not learnt. A first moment such as m2*sx2 is learnt "
        "through its product with the length before it: a length 1 % too long makes it 1 % too small."
    )


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value + 0.0:.6g}" for value in values)
