"""The motion of an arm under its control or under given torques (section 7), with its effects.

The default is a Runge-Kutta step on the full state. Friction makes the equations change at a standstill, so
every joint is in one of three modes, sliding forwards, sliding backwards or stuck; within a step the modes
are fixed and the equations smooth, and a step in which a joint comes to rest is cut there. A stuck joint
starts to slide when what pulls at it exceeds its static (or Coulomb) friction. The paper's own scheme
(docs/errata.md, slip 7) is ``scheme="paper"``.

All effects of `arm.effects` act in it but those of sensors. What is given and returned is what data have: the
angle on the motor's side of a transmission, and the torque that is asked for.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from arm.chain import chain_of, joint_rows
from arm.control import gains
from arm.drive import Commands
from arm.drive_state import KA, DriveState, unchanging
from arm.effects.effect_table import changed, effect_table
from arm.effects.joint_numbers import DELAY
from arm.effects.trials import AnyTrial
from arm.integration import effect_steps
from arm.kinematics import tip_position
from arm.model import Arm, Control, Floats
from arm.printed_scheme import paper_steps
from arm.room import make_room
from arm.way_before import set_way
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

    @property
    def of_links(self) -> tuple[Floats, Floats, Floats]:
        """Angle, velocity and acceleration of the links: the motors', where no transmission gives way."""
        return self.q, self.dq, self.ddq


@dataclass(frozen=True)
class GearedMotion(Motion):
    """A motion of motors, and that of the links beyond their transmissions, (n_sample, n_joint)."""

    link_q: Floats
    link_dq: Floats
    link_ddq: Floats

    @property
    def of_links(self) -> tuple[Floats, Floats, Floats]:
        """Angle, velocity and acceleration of the links."""
        return self.link_q, self.link_dq, self.link_ddq


def tip_of(arm: Arm, motion: Motion) -> Floats:
    """Return where the tip was in a simulation of an arm, (n_sample, 3) [m], by its effects and its links."""
    return tip_position(changed(arm), motion.of_links[0])


def simulate(
    arm: Arm,
    ref: Floats,
    dt_s: float,
    q0: Floats,
    dq0: Floats | None = None,
    scheme: Scheme = "rk4",
    torque: Floats | None = None,
    t0_s: float = 0.0,
    trial: AnyTrial = 1,
    drives: DriveState | None = None,
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
    t0_s : float
        The run's time at the first sample, for effects that depend on it.
    trial : int or TrialId
        Its number in the run, or what effects call it.
    drives : DriveState, optional
        Gains in place of the law's, and where the drives are engaged, from one sample to the next. Where they are
        not they give no torque, a given one neither.

    Returns
    -------
    Motion
        As many samples as ``ref`` has; a `GearedMotion` where a transmission has play or twists. An arm that no
        masses can have may run away to infinity.

    Raises
    ------
    ConfigError
        If the law is "measured" and no torque is given, an effect is not as the catalogue has it, or the scheme or
        law does not go with one.
    DataError
        If shapes don't fit.
    """
    targets = joint_rows(arm, "ref", ref)
    drive, law, schedule = _driven(arm, targets, torque, drives)
    if scheme == "paper" and drives is not None:
        raise ConfigError("the paper's scheme knows no drives that change; expected scheme 'rk4'")
    state = np.zeros((2, arm.n_joint))
    for part, name, start in ((state[0], "q0", q0), (state[1], "dq0", dq0)):
        if start is not None:
            if np.shape(start) != (arm.n_joint,):
                raise DataError(f"{name} has shape {np.shape(start)}, expected ({arm.n_joint},)")
            part[:] = start
    if scheme == "paper" and arm.effects:
        raise ConfigError("the paper's scheme knows no effects; expected scheme 'rk4' for an arm that has some")
    arm = changed(arm)
    effects = effect_table(arm, trial)
    if effects.geared and (law[2].any() or schedule[:, KA].any()):
        raise ConfigError(
            "control.law is 'pda', which does not go with backlash or joint_elasticity; expected 'pd'"
        )
    commands = Commands(law, torque is not None, drive, float(dt_s), float(t0_s))
    room = make_room(arm.n_joint, len(drive) if effects.numbers[DELAY].any() and torque is None else 0)
    if effects.driven:
        set_way(arm, commands, effects, trial, state, room.way)
    motion, lead = np.empty((4, *drive.shape)), np.empty((2, len(drive) if effects.geared else 0, arm.n_joint))
    if scheme == "rk4":
        effect_steps(chain_of(arm), commands, effects, room, state, motion, lead, schedule)
    else:
        paper_steps(chain_of(arm), commands, effects, room, state, motion, lead)
    t = np.arange(len(targets), dtype=np.float64) * dt_s
    if not effects.geared:
        return Motion(t, motion[0], motion[1], motion[2], motion[3], targets)
    surge = np.gradient(lead[1], dt_s, axis=0) if len(lead[1]) > 1 else np.zeros_like(lead[1])
    seen = (motion[0] + lead[0], motion[1] + lead[1], motion[2] + surge)
    return GearedMotion(t, *seen, motion[3], targets, motion[0], motion[1], motion[2])


def _driven(
    arm: Arm, targets: Floats, torque: Floats | None, drives: DriveState | None
) -> tuple[Floats, Floats, Floats]:
    """Return what drives a simulation: targets or torque, the law at the first sample, and its schedule."""
    drive = targets
    if torque is not None:
        drive = joint_rows(arm, "torque", torque)
        if len(drive) != len(targets):
            raise DataError(f"torque has {len(drive)} samples and ref has {len(targets)}; expected as many")
    elif arm.control.law == "measured":
        raise ConfigError("control.law is 'measured' and no torque is given: nothing drives the simulation")
    if drives is None:
        law = np.zeros((3, arm.n_joint)) if torque is not None else gains(arm.control, arm.n_joint)
        return drive, law, unchanging(arm.n_joint)
    if drives.on.shape != targets.shape:
        raise DataError(f"drives have shape {drives.on.shape} and ref has {targets.shape}; expected the same")
    schedule = drives.schedule(Control() if torque is not None else arm.control)
    return drive if torque is None else np.where(drives.on, drive, 0.0), schedule[0, : KA + 1].copy(), schedule
