"""The motion of an arm under its control or under given torques (section 7).

The default is a Runge-Kutta step on the full state. Friction makes the equations change at a standstill, so
every joint is in one of three modes, sliding forwards, sliding backwards or stuck; within a step the modes
are fixed and the equations smooth, and a step in which a joint comes to rest is cut there. A stuck joint
starts to slide when what pulls at it exceeds its static (or Coulomb) friction. The paper's own scheme
(docs/errata.md, slip 7) is ``scheme="paper"``.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.chain import chain_of, joint_rows
from arm.control import gains
from arm.integration import paper_steps, runge_kutta_steps
from arm.model import Arm, Floats
from limbcal.errors import ConfigError, DataError

Scheme = Literal["rk4", "paper"]


@dataclass(frozen=True)
class Motion:
    """A motion, sampled evenly: t (n_sample,) [s], the rest (n_sample, n_joint)."""

    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    tau: Floats
    ref: Floats


def simulate(
    arm: Arm,
    ref: Floats,
    dt_s: float,
    q0: Floats,
    dq0: Floats | None = None,
    scheme: Scheme = "rk4",
    torque: Floats | None = None,
) -> Motion:
    """Simulate an arm from a state on.

    Parameters
    ----------
    arm : Arm
        Its control law drives it, unless ``torque`` is given.
    ref : (n_sample, n_joint)
        The controller's target, held from one sample to the next.
    dt_s : float
        Step, and interval of the samples.
    q0, dq0 : (n_joint,)
        State at the first sample; at rest unless given.
    scheme : {"rk4", "paper"}
    torque : (n_sample, n_joint), optional
        Measured torque in place of a control law; between samples it changes linearly.

    Returns
    -------
    Motion
        As many samples as ``ref`` has. An arm that no masses can have may run away to infinity.

    Raises
    ------
    ConfigError
        If the law is "measured" and no torque is given.
    DataError
        If shapes don't fit.
    """
    targets = joint_rows(arm, "ref", ref)
    if torque is not None:
        drive, law = joint_rows(arm, "torque", torque), np.zeros((3, arm.n_joint))
        if len(drive) != len(targets):
            raise DataError(f"torque has {len(drive)} samples and ref has {len(targets)}; expected as many")
    elif arm.control.law == "measured":
        raise ConfigError("control.law is 'measured' and no torque is given: nothing drives the simulation")
    else:
        drive, law = targets, gains(arm.control, arm.n_joint)
    state = np.zeros((2, arm.n_joint))
    for part, name, start in ((state[0], "q0", q0), (state[1], "dq0", dq0)):
        if start is not None:
            if np.shape(start) != (arm.n_joint,):
                raise DataError(f"{name} has shape {np.shape(start)}, expected ({arm.n_joint},)")
            part[:] = start
    motion = np.empty((4, *targets.shape))
    steps = runge_kutta_steps if scheme == "rk4" else paper_steps
    steps(chain_of(arm), law, torque is not None, drive, dt_s, state, motion)
    t = np.arange(len(targets), dtype=np.float64) * dt_s
    return Motion(t, motion[0], motion[1], motion[2], motion[3], targets)
