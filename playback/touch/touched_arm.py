"""The simulated arm that is touched: its state, its effects, who holds it and where."""

import math

import numpy as np

from arm.chain import chain_of, poses
from arm.control import gains
from arm.drive import BEFORE, SHARE, Commands
from arm.effects.effect_table import changed, effect_table
from arm.effects.joint_numbers import DELAY, ROTOR
from arm.effects.payload import with_load
from arm.model import Arm, Floats
from arm.newton_euler import bias_torque, mass_matrix
from arm.outer_wrench import point_motion
from arm.resistance import friction_alone
from arm.way_before import set_way
from limbcal.errors import ConfigError, DataError
from playback.touch import coupling as c
from playback.touch.grip import Grip, Hand
from playback.touch.limit import UNBOUND, Coupling, mass_limit
from playback.touch.memory import Memory
from playback.touch.rotation import turned_between
from playback.touch.tick import tick

#: How fast an arm without a control law of its own returns to where it is held [rad/s].
_HOLD_RAD_S = 2.0 * math.pi * 2.0
#: For how long the coupling grows to its full stiffness after the arm was touched [s].
RAMP_S = 0.2
#: Effects that act in some trials only act as in the first.
_TRIAL = 1


class TouchedArm:
    """An arm in simulation, step by step, with all its effects, and the hand that holds it.

    An arm whose law is known is held by it; one whose torque was measured moves free until asked to `hold`.

    Parameters
    ----------
    arm : Arm
    q0 : (n_joint,)
        Where it rests at first [rad or m].
    step_s : float
    asked : Coupling

    Raises
    ------
    ConfigError
        If an effect is not as the catalogue has it, or does not go with the law.
    DataError
        If q0 does not fit.
    """

    def __init__(self, arm: Arm, q0: Floats, step_s: float, asked: Coupling) -> None:
        self.arm = changed(arm)
        self.asked = asked
        self.given = asked.within(step_s)
        effects = effect_table(self.arm, _TRIAL)
        self._own_law = None if arm.control.law == "measured" else gains(arm.control, arm.n_joint)
        if effects.geared and self._own_law is not None and self._own_law[2].any():
            raise ConfigError(
                "control.law is 'pda', which does not go with backlash or joint_elasticity; expected 'pd'"
            )
        delay = float(effects.numbers[DELAY].max(initial=0.0))
        n_past = math.ceil(delay / step_s) + 3 if delay > 0.0 else 0
        self.memory = Memory(chain_of(self.arm), effects, n_past, step_s)
        parts = self.memory.parts
        self._chain, self._effects, self._room, self._touch = parts.chain, parts.effects, parts.room, parts.touch
        self._law, self._drive, self._clock = parts.commands.law, parts.commands.drive, parts.clock
        self._room.way.state[SHARE] = 1.0
        self.state = parts.state
        self._held_s = self._unheard_s = 0.0
        self._turned: Floats | None = None
        self._follows = UNBOUND, UNBOUND
        self._within_s = 0.0
        self._grown = False
        friction_alone(self._chain, self._effects, self._room)
        self.reset(q0)

    @property
    def step_s(self) -> float:
        """Length of a step [s]."""
        return float(self._clock[1])

    @property
    def tip(self) -> Grip:
        """The far end of the last link."""
        return Grip(self.arm.n_joint, (self.arm.joints[-1].a_m, 0.0, 0.0))

    def reset(self, q: Floats) -> None:
        """Put the arm to rest somewhere, let go, under its own law if it has one.

        Raises
        ------
        DataError
            If ``q`` does not fit or is not finite.
        """
        q = self._fitting(q)
        self.let_go()
        self.state[:] = 0.0
        self.state[0] = q
        if self._own_law is not None:
            self._law[:], self._drive[:], self._free = self._own_law, q, False
        else:
            self._law[:], self._drive[:], self._free = 0.0, 0.0, True
        if self._effects.driven:
            commands = Commands(self._law, self._free, self._drive[-1:], self.step_s, float(self._clock[0]))
            set_way(self.arm, commands, self._effects, _TRIAL, self.state[:2], self._room.way)
            self._room.way.past[:] = self._room.way.state[BEFORE]
        self._touch.account[:] = 0.0

    def hold(self, q: Floats | None = None) -> None:
        """Have the arm held at ``q``, or where it is: by its own law, or one that is made for it.

        Raises
        ------
        DataError
            If ``q`` does not fit or is not finite.
        """
        target = self.state[0].copy() if q is None else self._fitting(q)
        if self._own_law is not None:
            self._law[:], self._drive[:] = self._own_law, target
        else:  # every joint as if it were alone, critically damped; the weight is carried
            inertia = np.diag(self._mass_matrix(target))
            weight = bias_torque(self._loaded(), target[None], np.zeros((1, self.arm.n_joint)))[0]
            self._law[0], self._law[1] = inertia * _HOLD_RAD_S**2, -2.0 * inertia * _HOLD_RAD_S
            self._law[2] = 0.0
            self._drive[:] = target + weight / self._law[0]
        self._free = False

    def free(self) -> None:
        """Switch the drives off: only friction holds the arm."""
        self._law[:], self._drive[:], self._free = 0.0, 0.0, True

    def take(self, grip: Grip, hand: Hand) -> None:
        """Let a hand take hold of a point; the coupling grows from nothing.

        Raises
        ------
        DataError
            If there is no such link.
        """
        if not 1 <= grip.joint <= self.arm.n_joint:
            raise DataError(f"joint is {grip.joint}, expected one of 1 to {self.arm.n_joint}")
        t = self._touch
        self.let_go()
        t.joint[0], t.point[:] = grip.joint - 1, grip.point_m
        t.path[:], t.seen[:], t.sent[:], t.twist[:] = hand.position, 0.0, 0.0, 0.0
        poses(self._chain, self.state[0], self._room.R, self._room.p)
        point_motion(self._chain, self._room.R, self._room.p, self.state[1], t.joint[0], t.point, t.axes, t.moving)
        t.frame[:] = t.axes
        self._turned = None if hand.orientation is None else hand.orientation.T @ t.axes
        self._held_s = self._unheard_s = 0.0
        self._limits()
        self._within_s, self._grown = 0.0, False

    def let_go(self) -> None:
        """Let nobody hold the arm."""
        self._touch.joint[0] = -1
        self._touch.sent[:] = self._touch.felt[:] = 0.0
        self._turned = None

    @property
    def _free(self) -> bool:
        return bool(self.memory.parts.counts[1])

    @_free.setter
    def _free(self, free: bool) -> None:
        self.memory.parts.counts[1] = free

    def step(self, n_step: int, hand: Hand | None = None, interval_s: float | None = None) -> None:
        """Take the arm some steps on.

        Parameters
        ----------
        n_step : int
        hand : Hand, optional
            Where the hand that holds the arm is now, if it has said so since the last step.
        interval_s : float, optional
            What `Coupling.within` is to hold for; a step unless given.
        """
        t, heard, dt = self._touch, hand is not None, n_step * self.step_s
        if t.joint[0] >= 0:
            self._held_s += dt
            self._unheard_s += dt
            self._stiffen(self.step_s if interval_s is None else interval_s)
        if hand is not None:
            since = self._unheard_s
            t.path[1] = hand.position
            t.seen[0] = (t.path[1] - t.path[0]) / since if hand.velocity is None else hand.velocity
            if hand.orientation is not None and self._turned is not None:
                t.twist[:] = turned_between(hand.orientation @ self._turned, t.frame, t.room[0])
                t.seen[1] = t.twist / since
            t.numbers[c.INTERVAL] = since
            self._unheard_s = 0.0
        tick(*self.memory.arrays, n_step, heard)

    @property
    def felt(self) -> Floats:
        """Force and moment on the hand, the latter about the touched point, (2, 3) [N], [N m]."""
        return self._touch.felt

    def touched_point(self, grip: Grip) -> Floats:
        """Return where a point of a link is now, (3,) [m]."""
        held = self._touch
        if held.joint[0] == grip.joint - 1 and held.point.tolist() == list(grip.point_m):
            at: Floats = held.moving[0]  # known already
            return at.copy()
        axes, moving = np.empty((3, 3)), np.empty((3, 3))  # as the coupling reckons it, to the last bit
        R, p, point = np.empty_like(self._room.R), np.empty_like(self._room.p), np.array(grip.point_m, dtype=float)
        poses(self._chain, self.state[0], R, p)
        point_motion(self._chain, R, p, self.state[1], grip.joint - 1, point, axes, moving)
        return np.asarray(moving[0])

    def energy(self) -> dict[str, object]:
        """Return the account of the coupling [J], and whether no more has come out than went in."""
        hand, arm, injected, device, stored, braked = self._touch.account.tolist()
        dissipated = hand + injected - arm - stored
        passive = dissipated + device >= -1e-9 * (1.0 + abs(hand) + abs(arm))
        return {
            "hand": hand,
            "arm": arm,
            "injected": injected,
            "stored": stored,
            "dissipated": dissipated,
            "device": device,
            "braked_ticks": int(braked),
            "passive": passive,
        }

    def _stiffen(self, interval_s: float) -> None:
        if interval_s == self._within_s and self._grown:
            return
        if interval_s != self._within_s:
            self.given = self.asked.within(interval_s, *self._follows)
            self._within_s = interval_s
        given = self.given
        share, x = min(self._held_s / RAMP_S, 1.0), self._touch.numbers
        self._grown = share == 1.0
        x[c.STIFFNESS], x[c.DAMPING] = share * given.stiffness, share * given.damping
        turns = 0.0 if self._turned is None else share
        x[c.TURN_STIFFNESS], x[c.TURN_DAMPING] = turns * given.turn_stiffness, turns * given.turn_damping
        x[c.DEVICE], x[c.TURN_DEVICE], x[c.TURN_LIMIT] = given.device, given.turn_device, given.max_moment
        walled = given.wall is not None
        x[c.LIMIT] = given.max_force / 2.0 if walled else given.max_force
        x[c.WALL_LIMIT] = given.max_force / 2.0 if walled else 0.0
        if given.wall is not None:
            self._touch.wall[:] = given.wall
            x[c.WALL_STIFFNESS] = share * (given.wall_stiffness or 0.0)

    def _limits(self) -> None:
        """Find out which stiffness and damping the arm's step can follow at the touched point."""
        t, n = self._touch, self.arm.n_joint
        J = np.empty((2, 3, n))
        axes, moving = np.empty((3, 3)), np.empty((3, 3))
        for i, unit in enumerate(np.eye(n)):
            point_motion(self._chain, self._room.R, self._room.p, unit, t.joint[0], t.point, axes, moving)
            J[:, :, i] = moving[1:]
        M = self._mass_matrix(self.state[0]) - np.diag(self._law[2])  # eq. (6): ka ddq belongs with M ddq
        mobility = J @ np.linalg.solve(M, J.transpose(0, 2, 1))
        light, easy = (max(float(np.linalg.eigvalsh(part)[-1]), 1e-12) for part in mobility)
        self._follows = mass_limit(1.0 / light, self.step_s), mass_limit(1.0 / easy, self.step_s)

    def _mass_matrix(self, q: Floats) -> Floats:
        """Return that of the links, of what the arm carries now, and of rotors."""
        return np.asarray(mass_matrix(self._loaded(), q)[0] + np.diag(self._effects.numbers[ROTOR]))

    def _loaded(self) -> Arm:
        """Return the arm with what it carries now."""
        since_s, mass_kg = self._effects.payload.T
        load_kg = float(mass_kg[since_s <= self._clock[0]].sum())
        return with_load(self.arm, load_kg) if load_kg else self.arm

    def _fitting(self, q: Floats) -> Floats:
        q = np.asarray(q, dtype=np.float64)
        if q.shape != (self.arm.n_joint,) or not np.isfinite(q).all():
            raise DataError(f"q is {q.tolist()}, expected {self.arm.n_joint} finite numbers")
        return q
