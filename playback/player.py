"""What is being played, and which frame is due when."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from arm.kinematics import sensor_positions, tip_position
from playback.source import Source
from playback.trajectory import Trajectory

NOMINAL_SPEED = 1.0


@dataclass(frozen=True)
class Clocks:
    """The time of deadlines [s] and the time of day that subscribers are told (UTC) [ns]."""

    monotonic: Callable[[], float]
    wall_ns: Callable[[], int]


@dataclass(frozen=True)
class _Run:
    """One time through a trial: when it began, on both clocks."""

    start_s: float
    start_ns: int


class Player:
    """Plays a source's trials from beginning to end, frame by frame.

    Frame k of a trial is due k periods after `play`, never one period after the frame before it; so delays do
    not add up, and after a hold-up every frame is still sent, with the time at which it was due.

    Parameters
    ----------
    source : Source
    rate_hz : float
        Frames a second.
    clocks : Clocks
    trial : int, optional
        What to load first; the source's first trial unless given.

    Raises
    ------
    ConfigError
        If there is no such trial.
    """

    def __init__(self, source: Source, rate_hz: float, clocks: Clocks, trial: int | None = None) -> None:
        self.source = source
        self.rate_hz = rate_hz
        self.finished = 0  # how many times a trial was played to its end
        self._clocks = clocks
        self._run: _Run | None = None
        self.load(trial)

    def load(self, trial: int | None = None) -> None:
        """Take another trial, stopping what plays; nothing changes where that fails.

        Raises
        ------
        ConfigError
            If there is no such trial.
        DataError
            If its motion cannot be made.
        """
        motion = self.source.load(trial)
        self._motion: Trajectory = motion
        self._trial = self.source.trials[0] if trial is None else trial
        # a frame beyond the last node by rounding alone is the last node
        self._n_frame = int(motion.duration_s * self.rate_hz + 1e-6) + 1
        self.stop()
        self._frame(0, 0)  # loads the compiled kernels, which would make the first frames late

    def play(self) -> None:
        """Start from the beginning; what plays already goes on undisturbed."""
        if self._run is None:
            self._run = _Run(self._clocks.monotonic(), self._clocks.wall_ns())
            self._next = 0

    def stop(self) -> None:
        """Stop and go back to the beginning."""
        self._run = None
        self._next = 0

    @property
    def playing(self) -> bool:
        """Whether frames are due."""
        return self._run is not None

    def deadline_s(self) -> float | None:
        """Return when the next frame is due on the monotonic clock, None while nothing plays."""
        return None if self._run is None else self._run.start_s + self._next / self.rate_hz

    def take_due(self) -> dict[str, object] | None:
        """Return the fields of the frame that is due, or None while none is.

        ``tip`` and ``points`` come from the arm's geometry at the joint angles. A playback has no
        accelerometers, so ``points`` is not dead reckoning here, as it is in `limb/frames`.
        """
        deadline_s = self.deadline_s()
        if self._run is None or deadline_s is None or self._clocks.monotonic() < deadline_s:
            return None
        k = self._next
        t0_ns = self._run.start_ns + round(k * 1e9 / self.rate_hz)
        self._next += 1
        if self._next == self._n_frame:
            self._run = None
            self.finished += 1
        return self._frame(k, t0_ns)

    def state(self) -> dict[str, object]:
        """Return the whole state, in plain values."""
        last = max(self._next - 1, 0)
        return {
            "playing": self.playing,
            "trial": self._trial,
            "position_s": min(last / self.rate_hz, self._motion.duration_s),
            "duration_s": self._motion.duration_s,
            "rate_hz": self.rate_hz,
            "speed": NOMINAL_SPEED,
            "source": self.source.name,
            "trials": list(self.source.trials),
            "finished": self.finished,
        }

    def _frame(self, k: int, t0_ns: int) -> dict[str, object]:
        t = k / self.rate_hz
        q, dq, ddq = self._motion.at(np.array([t]))
        return {
            "frame0": k,
            "t0_ns": t0_ns,
            "dt_s": 1.0 / self.rate_hz,
            "n": 1,
            "method": self._motion.method,
            "q": q,
            "dq": dq,
            "ddq": ddq,
            "tip": tip_position(self.source.arm, q),
            "points": sensor_positions(self.source.arm, q),
            "gap": self._motion.gap_between(max(t - 1.0 / self.rate_hz, 0.0), t),
            "source": self.source.name,
            "speed": NOMINAL_SPEED,
        }
