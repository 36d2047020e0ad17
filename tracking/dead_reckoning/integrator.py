"""The paper's tracker: dead reckoning from rest to rest.

It drifts, and says nothing of its own uncertainty; it is what the paper describes, and the reference that better
trackers are measured against.
"""

from bisect import bisect_left
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from arm.kinematics import sensor_positions, tips_of
from arm.model import Arm, Floats
from limbcal.errors import ConfigError, DataError
from tracking.dead_reckoning.cells import reckon_cells
from tracking.dead_reckoning.integration import gravity_readings, reckon
from tracking.dead_reckoning.integration_state import reckoning_of
from tracking.dead_reckoning.rest import RestDetector
from tracking.dead_reckoning.rest_contrasts import contrasts, gravity_slack
from tracking.model.differences import CentralDifferences
from tracking.model.frame_means import FrameMeans
from tracking.model.frames import Block, Frames, Phase

Zero = Literal["each-rest", "first-rest"]
#: A cell is what is judged at once for rest, and what a block of frames covers.
_CELL_S = 0.01
#: The moving average of four looks back by one and a half samples on the mean.
_DELAY_SAMPLES = 1.5


class Integrator:
    """Joint motion by the moving average of four, double Euler integration and two positions a link.

    Parameters
    ----------
    arm : Arm
        Its lengths are used for the tip only; the angles come from how the sensors sit on their links.
    rate_hz : float
    initial_q_rad : (n_joint,)
        Where the arm rests when tracking begins.
    frame_rate_hz : float
        Rounded to what divides the sampling rate, which it is where that is lower.
    zero : {"each-rest", "first-rest"}
        When velocities are set to zero and offsets learnt: at each rest that is recognised, or, as the paper
        does it, only before the first motion.

    Raises
    ------
    ConfigError
        If the arm's sensors cannot give its angles, or a number makes no sense.
    """

    method = "integrate"

    def __init__(
        self,
        arm: Arm,
        rate_hz: float,
        initial_q_rad: Floats,
        frame_rate_hz: float = 1000.0,
        zero: Zero = "each-rest",
    ) -> None:
        q0 = np.array(initial_q_rad, dtype=float)
        if q0.shape != (arm.n_joint,):
            raise ConfigError(f"initial_q_rad has shape {q0.shape}, expected one angle a joint ({arm.n_joint},)")
        if not frame_rate_hz > 0.0:
            raise ConfigError(f"frame_rate_hz is {frame_rate_hz:g}, expected more than 0")
        self._arm = arm
        self._zero = zero
        self._dt_sample = 1.0 / rate_hz
        self._decimation = max(1, round(rate_hz / frame_rate_hz))
        self.dt_s = self._decimation * self._dt_sample
        self._cell = max(2, self._decimation * max(1, round(_CELL_S / self.dt_s)))  # one reading shows no noise
        self._n_channel, self._n_read = 3 * len(arm.sensors), arm.n_channel
        self._state = reckoning_of(arm, q0)
        self._rest = RestDetector(contrasts(self._state), gravity_slack(arm, self._state))
        self._state = self._state._replace(offset=self._rest.offset)  # which is learnt in place
        gravity_readings(self._state)
        self._rest_q = q0.copy()
        self._rest_points: Floats = self._state.start
        self._pending = np.empty((0, self._n_channel))
        self._sample = 0
        self._trial = 0
        self._primed = False
        self._lost = self._held = False
        self._phase = self._decimation // 2
        self._differences = CentralDifferences(self.dt_s, arm.n_joint)
        self._waiting = _Underived(0, 0, np.empty((0, arm.n_joint)), np.empty((0, *self._state.moved.shape)))
        self._felt = FrameMeans(self._decimation, self._n_channel, rate_hz)

    def push(self, t0_ns: int, readings: Floats) -> tuple[list[Frames], list[Phase]]:
        """Take in readings and give out the frames and phases that they complete.

        Parameters
        ----------
        t0_ns : int
            Time of the first reading.
        readings : (n, n_channel) [m/s^2]
            Specific force in each sensor's own axes, columns s1x s1y s1z s2x ...; what gyroscopes read after them
            is left aside, for which double integration has no use.

        Returns
        -------
        frames : list of Frames
        phases : list of Phase

        Raises
        ------
        DataError
            If the number of columns is not three a sensor and three a gyroscope.
        """
        return self.push_all([(t0_ns, readings)])[0]

    def push_all(self, blocks: Sequence[Block]) -> list[tuple[list[Frames], list[Phase]]]:
        """Do `push` with blocks of readings in a row, (t0_ns, readings); return what each of them completes."""
        end = self._sample + len(self._pending)
        parts, ends, anchors = [self._pending] if len(self._pending) else [], [], []
        for t0_ns, readings in blocks:
            if readings.ndim != 2 or readings.shape[1] != self._n_read:
                raise DataError(f"readings have shape {readings.shape}, expected (n, {self._n_read})")
            anchors.append((t0_ns, end))
            ends.append(end := end + len(readings))
            parts.append(readings[:, : self._n_channel])
        self._pending = np.ascontiguousarray(parts[0] if len(parts) == 1 else np.concatenate(parts), dtype=float)
        completed: list[tuple[list[Frames], list[Phase]]] = [([], []) for _ in blocks]
        while len(self._pending) >= (size := self._cell - self._sample % self._cell):
            done = self._stride(ends, anchors, completed) if size == self._cell else 0
            if not done:
                k = bisect_left(ends, self._sample + size)
                self._anchor_ns, self._anchor_sample = anchors[k]
                self._advance(size, *completed[k])
        self._anchor_ns, self._anchor_sample = anchors[-1]
        self._pending = self._pending.copy()  # what is left; the readings themselves are the caller's
        return completed

    def gap(self, n_samples: int) -> tuple[list[Frames], list[Phase]]:
        """Bridge samples that were lost: every sensor goes on as fast as it went.

        Returns what the samples before the gap still complete.
        """
        completed = self.flush()
        self._sample += n_samples
        self._felt.skip_to(self._sample)
        self._state.moved[:] += self._state.velocity * (n_samples * self._dt_sample)
        self._rest.forget()
        self._primed = False
        self._lost = True
        return completed

    def retime(self, rate_hz: float) -> None:
        """Go on with samples of a rate that differs so little that a frame stays as many samples.

        Parameters
        ----------
        rate_hz : float
        """
        self._dt_sample = 1.0 / rate_hz
        self.dt_s = self._decimation * self._dt_sample
        self._differences.retime(self.dt_s)

    def flush(self) -> tuple[list[Frames], list[Phase]]:
        """Give out what waits for more samples, at the end of a recording."""
        frames: list[Frames] = []
        phases: list[Phase] = []
        if len(self._pending):
            self._advance(len(self._pending), frames, phases)
        self._emit(self._waiting, *self._differences.flush(), frames)
        return frames, phases

    def _advance(self, size: int, frames: list[Frames], phases: list[Phase]) -> None:
        """Carry the state through the next ``size`` pending samples: a cell, or a part of one."""
        cell, self._pending = self._pending[:size], self._pending[size:]
        state = self._state
        self._felt.push(cell)
        if not self._primed:  # the moving average begins as if the first reading had stood there before
            state.recent[:] = cell[0]
            self._primed = True
        resting = was_resting = self._rest.resting
        if size == self._cell:
            resting = self._rest.judge(cell, state.gravity, self._zero == "first-rest")
        if self._rest.jolted and size == self._cell:  # the motion before ended, if not in what counts as rest
            phases.append(Phase("end", self._time_ns(self._sample), self._trial))
        if resting != was_resting or (self._rest.jolted and size == self._cell):
            self._trial += not resting
            phases.append(Phase("end" if resting else "begin", self._time_ns(self._sample), self._trial))
        hold = resting and (self._zero == "each-rest" or self._trial == 0)
        if hold:
            self._settle()
        self._held = hold
        waiting = len(self._waiting.q)  # with it at the front nothing has to be put together afterwards
        q = np.empty((waiting + size // self._decimation + 1, len(state.q)))
        moved = np.empty((len(q), *state.moved.shape))
        q[:waiting], moved[:waiting] = self._waiting.q, self._waiting.moved
        n = reckon(
            state,
            cell,
            self._dt_sample,
            hold,
            self._sample,
            self._decimation,
            self._phase,
            q[waiting:],
            moved[waiting:],
        )
        if n:
            due = (self._phase - self._sample) % self._decimation  # the cell's first sample that makes a frame
            oldest = self._sample + due - waiting * self._decimation
            number, t_ns, whole = oldest // self._decimation, self._time_ns(oldest - _DELAY_SAMPLES), waiting + n
            derivatives = self._differences.push(q[waiting:whole], hold)
            self._emit(_Underived(number, t_ns, q[:whole], moved[:whole]), *derivatives, frames)
        self._sample += size

    def _stride(
        self,
        ends: Sequence[int],
        anchors: Sequence[tuple[int, int]],
        completed: Sequence[tuple[list[Frames], list[Phase]]],
    ) -> int:
        """Carry the state through the next pending cells in which nothing happens; return how many those are.

        Each is completed by the block that ends with it or after it, and has its times.
        """
        steady = self._primed and self._rest.settled and self._felt.noise is not None
        if not (steady and len(self._waiting.q) == 1 and self._rest.resting == self._held):
            return 0
        state, size, per_cell = self._state, self._cell, self._cell // self._decimation
        n = len(self._pending) // size
        q, moved = np.empty((1 + n * per_cell, len(state.q))), np.empty((1 + n * per_cell, *state.moved.shape))
        q[0], moved[0] = self._waiting.q[0], self._waiting.moved[0]
        done, window = reckon_cells(
            state,
            self._rest.window,
            self._pending[: n * size],
            size,
            self._dt_sample,
            self._held,
            self._zero != "first-rest",
            self._sample,
            self._decimation,
            self._phase,
            q[1:],
            moved[1:],
        )
        if not done:
            return 0
        self._rest.go_on(window)
        self._felt.push(self._pending[: done * size])
        self._pending = self._pending[done * size :]
        rows = done * per_cell
        dq, ddq = self._differences.push(q[1 : 1 + rows], self._held)
        tip, number = tips_of(state.chain, q[:rows]), self._waiting.number
        felt = self._felt.means(number, rows)
        for k in range(done):
            block, here = bisect_left(ends, self._sample + size), slice(k * per_cell, (k + 1) * per_cell)
            self._anchor_ns, self._anchor_sample = anchors[block]
            t_ns = self._time_ns(self._sample + self._phase - self._decimation - _DELAY_SAMPLES)
            whole = (q[here], dq[here], ddq[here], tip[here], moved[here])
            frames = Frames(
                number + here.start, t_ns, self.dt_s, *whole, self._lost, None, felt[here], self._felt.noise
            )
            completed[block][0].append(frames)
            self._lost = False
            self._sample += size
        last_ns = t_ns + round(per_cell * self.dt_s * 1e9)
        self._waiting = _Underived(number + rows, last_ns, q[rows : rows + 1], moved[rows : rows + 1])
        return done

    def _emit(self, known: "_Underived", dq: Floats, ddq: Floats, frames: list[Frames]) -> None:
        """Give out the frames whose derivatives are there; the last one waits for the next."""
        number, t_ns, q, moved = known
        n = len(dq)
        if n:
            tip = tips_of(self._state.chain, q[:n])
            felt, noise = self._felt.means(number, n), self._felt.noise
            whole = (q[:n], dq, ddq, tip, moved[:n])
            frames.append(Frames(number, t_ns, self.dt_s, *whole, self._lost, None, felt, noise))
            self._lost = False
        self._waiting = _Underived(number + n, t_ns + round(n * self.dt_s * 1e9), q[n:], moved[n:])

    def _settle(self) -> None:
        """Take out what integration has done to a resting arm: its speed, and the length between two sensors."""
        state = self._state
        state.velocity[:] = 0.0
        now = self._at_rest(state.q)
        one, two = state.pair[:, 0], state.pair[:, 1]
        state.baseline[:] = now[two] - now[one] - (state.moved[two] - state.moved[one])

    def _at_rest(self, q: Floats) -> Floats:
        """Return where the sensors are, (n_sensor, 3); while the arm rests its angles stand."""
        if not np.array_equal(q, self._rest_q):
            self._rest_q, self._rest_points = q.copy(), sensor_positions(self._arm, q)[0]
        return self._rest_points

    def _time_ns(self, sample: float) -> int:
        """Return the time of a sample, as the latest push has it."""
        return self._anchor_ns + round((sample - self._anchor_sample) * self._dt_sample * 1e9)


class _Underived(NamedTuple):
    """Frames without their derivatives: the number and the time [ns] of the first, and their rows."""

    number: int
    t_ns: int
    q: Floats
    moved: Floats
