"""The haptic loop: a thousand times a second devices are heard, the arm steps, and hands feel it."""

import math
import time
import uuid
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import zmq

from arm.model import Arm
from limbcal.errors import LimbcalError
from playback.touch.channel import HapticChannel, Heard
from playback.touch.frame_stream import FRAME_RATE_HZ, FrameStream
from playback.touch.grip import Grip, Hand
from playback.touch.holders import Holders
from playback.touch.limit import Coupling, sampled_interval
from playback.touch.message import Command, Input
from playback.touch.pace import Pace, Spread
from playback.touch.touched_arm import TouchedArm
from protocol.curve import Gate
from protocol.message import HEALTH, PLAY
from protocol.publisher import Publisher

#: Period of `limb/health` [s], see docs/protocol.md.
HEARTBEAT_S = 1.0
#: Steps that one tick makes up for at most; time beyond is lost to the arm.
MOST_STEPS = 20
#: Over how long the rates that are held are measured [s], and how much of a measurement counts at once.
_WINDOW_S, _SHARE = 0.1, 0.3


@dataclass(frozen=True)
class Setup:
    """What a haptic loop is to simulate, how, and where it is reached."""

    arm: Arm
    q0: tuple[float, ...]
    rate_hz: float
    coupling: Coupling = field(default_factory=Coupling)
    endpoint: str = "tcp://127.0.0.1:*"
    haptic: str = "tcp://127.0.0.1:*"
    keys: Path | None = None


class TouchLoop:
    """The arm, its channel to devices and its stream.

    Parameters
    ----------
    context : zmq.Context
    setup : Setup
    touched : TouchedArm
        Compiled already: it has made a step.
    pace : Pace
    gate : Gate, optional
    real_time : bool
        Whether the process is served before others.

    Raises
    ------
    DeviceError
        If an endpoint is taken or cannot be bound.
    ConfigError
        If an endpoint is not one.
    """

    def __init__(
        self,
        context: "zmq.Context[zmq.Socket[bytes]]",
        setup: Setup,
        touched: TouchedArm,
        pace: Pace,
        gate: Gate | None = None,
        real_time: bool = False,
    ) -> None:
        self.arm, self.pace = touched, pace
        self._real_time = real_time
        self._publisher = Publisher(context, setup.endpoint, setup.arm.name, str(uuid.uuid4()), gate)
        try:
            self._channel = HapticChannel(context, setup.haptic, setup.arm.n_joint, gate)
        except BaseException:
            self._publisher.close()
            raise
        self.endpoint, self.haptic = self._publisher.endpoint, self._channel.endpoint
        self._stream = FrameStream(touched)
        self._holders = Holders()
        self._q0, self._resets = np.array(setup.q0), 0
        self._holder: bytes | None = None
        self._grip = touched.tip
        self._steps = Spread()
        self._frames = self._heartbeats = self._inputs = self._lost_steps = 0
        self._interval_s = self._loop_s = pace.period_s
        self._window_s, self._window_ticks, self._window_inputs = pace.start_s, 0, 0

    def tick(self, passed: int) -> None:
        """Do all that is due at a tick, ``passed`` periods after the last one."""
        now_s = self.pace.now_s
        heard, answers, hand = self._hear(now_s), [], None
        holder = self._holders.holder(now_s)
        if self._holder not in (None, holder):  # it fell silent, or another's touch has begun
            self.arm.let_go()
            self._holder = None  # until whoever holds it now is heard, and takes hold
        for item in heard:
            assert isinstance(item.said, Input)
            if item.envelope[0] == holder:
                hand = self._grasp(holder, item.said)
            answers.append((item, item.envelope[0] == holder))
        n_step = min(passed, MOST_STEPS)
        self._lost_steps += passed - n_step
        begin = time.perf_counter()
        self.arm.step(n_step, hand, sampled_interval(self._interval_s, self._loop_s))
        self._steps.add(time.perf_counter() - begin)
        if not math.isfinite(float(self.arm.state.sum() + self.arm.felt.sum())):
            self._run_away()
        for item, holds in answers:
            self._channel.answer(item.envelope, self._felt(item.said.seq, holds))
        self._measure(now_s, hand is not None)
        self._publish(now_s)

    def health(self) -> dict[str, object]:
        """Return what `limb/health` says."""
        force = self.arm.felt[0]
        return {
            "uptime_s": self.pace.now_s - self.pace.start_s,
            "last_seq": dict(self._publisher.last_seq),
            "rate_hz": 1.0 / self.pace.period_s,
            "held_rate_hz": self.pace.held_rate_hz,
            "ticks": self.pace.ticks,
            "overruns": self.pace.overruns,
            "lost_steps": self._lost_steps,
            "lateness_ms": self.pace.lateness.summary(1e-3),
            "step_us": self._steps.summary(1e-6),
            "energy_J": self.arm.energy(),
            "stiffness_N_m": self.arm.given.stiffness,
            "damping_N_s_m": self.arm.given.damping,
            "wall_stiffness_N_m": self.arm.given.wall_stiffness,
            "interval_ms": 1e3 * self._interval_s,
            "inputs": self._inputs,
            "resets": self._resets,
            "devices": len(self._holders),
            "connected": self._holder is not None,
            "stale": self._holder is None,
            "force_N": float((force @ force) ** 0.5),
            "real_time": self._real_time,
        }

    def first_frames(self) -> None:
        """Make one frame and one answer: they load the compiled kernels, which would make the first ticks late."""
        self._stream.frame(0, self.arm.felt, self.arm.touched_point(self._grip))
        self._felt(None, False)

    def close(self) -> None:
        """Let what was sent last leave, and free both endpoints."""
        self._channel.close()
        self._publisher.close()

    def _hear(self, now_s: float) -> list[Heard]:
        """Carry out commands, note who spoke, and return the inputs."""
        inputs = []
        for heard in self._channel.drain():
            if isinstance(heard.said, Command):
                try:
                    self._carry_out(heard.said)
                except LimbcalError as error:
                    self._channel.answer(heard.envelope, {"error": str(error)})
                    continue
                self._channel.answer(heard.envelope, self._felt(heard.said.seq, False))
            else:
                self._holders.hear(heard.envelope[0], now_s)
                inputs.append(heard)
        return inputs

    def _carry_out(self, command: Command) -> None:
        if command.cmd == "hold":
            self.arm.hold(command.q)
        elif command.cmd == "free":
            self.arm.free()
        elif command.cmd == "reset":
            self.arm.reset(self.arm.state[0].copy() if command.q is None else command.q)
            self._holder = None

    def _grasp(self, holder: bytes, said: Input) -> Hand:
        """Return the hand of the device that holds the arm, which takes hold first where it is new there."""
        tip = self.arm.tip
        joint = tip.joint if said.joint is None else said.joint
        point = said.point
        if point is None:
            point = (self.arm.arm.joints[joint - 1].a_m, 0.0, 0.0)
        grip, hand = Grip(joint, point), Hand(said.position, said.velocity, said.orientation)
        if holder != self._holder or grip != self._grip:
            self.arm.take(grip, hand)
            self._grip, self._holder = grip, holder
            self._interval_s, self._window_inputs = self._loop_s, 0
            self._window_s, self._window_ticks = self.pace.now_s, 0
        return hand

    def _felt(self, seq: int | None, holds: bool) -> dict[str, object]:
        force, moment = self.arm.felt.tolist() if holds else ([0.0] * 3, [0.0] * 3)
        return {
            "force": force,
            "moment": moment,
            "q": self.arm.state[0].tolist(),
            "dq": self.arm.state[1].tolist(),
            "point": self.arm.touched_point(self._grip).tolist(),
            "t_ns": time.time_ns(),
            "seq": seq,
            "holds": holds,
            "stale": self._holder is None,
        }

    def _run_away(self) -> None:
        """Put an arm that has run away to infinity back to where it began: nobody is to feel that."""
        self.arm.reset(self._q0)
        self._holder = None
        self._resets += 1

    def _measure(self, now_s: float, heard: bool) -> None:
        """Measure the rates of loop and device that are really held: the coupling is as stiff as they allow."""
        self._window_ticks += 1
        self._window_inputs += heard
        self._inputs += heard
        elapsed_s = now_s - self._window_s
        if elapsed_s < _WINDOW_S:
            return
        self._loop_s = elapsed_s / self._window_ticks
        slowest_s = self._loop_s
        if self._holder is not None and self._window_inputs:
            slowest_s = max(slowest_s, elapsed_s / self._window_inputs)
        self._interval_s += _SHARE * (slowest_s - self._interval_s)
        self._window_s, self._window_ticks, self._window_inputs = now_s, 0, 0

    def _publish(self, now_s: float) -> None:
        uptime_s = now_s - self.pace.start_s
        if uptime_s * FRAME_RATE_HZ >= self._frames:
            self._publisher.publish(
                PLAY, self._stream.frame(self._frames, self.arm.felt, self.arm.touched_point(self._grip))
            )
            self._frames = int(uptime_s * FRAME_RATE_HZ) + 1
        elif uptime_s >= self._heartbeats * HEARTBEAT_S:  # never both in one tick
            self._publisher.publish(HEALTH, self.health())
            self._heartbeats = int(uptime_s / HEARTBEAT_S) + 1
