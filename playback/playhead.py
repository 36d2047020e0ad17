"""Where in a motion playback is, and when the next frame of it is due."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from limbcal.errors import ConfigError
from playback.trajectory import Floats

#: Speeds that can be asked for, as multiples of the motion's own; conventions.
MIN_SPEED, MAX_SPEED = 0.1, 10.0
#: A frame beyond the end by rounding alone is the end.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class Clocks:
    """The time of deadlines [s] and the time of day that subscribers see (UTC) [ns]."""

    monotonic: Callable[[], float]
    wall_ns: Callable[[], int]


class Due(NamedTuple):
    """A frame: its number since the motion began, its place in the motion, and when it was due (UTC)."""

    number: int
    position_s: float
    t0_ns: int


@dataclass
class _Stretch:
    """Frames at an even pace: frame ``k`` is due ``k`` periods after its start, on both clocks."""

    start_s: float
    start_ns: int
    position_s: float
    k: int = 0


class Playhead:
    """Moves through a motion, frame by frame.

    Frame k is due k periods after `play`, never one period after the frame before it; so delays do not add up,
    and after a hold-up every frame is still due, with the time at which it should have been. Neither another
    speed nor another place nor a new round moves that beat.

    Parameters
    ----------
    rate_hz : float
        Frames a second, whatever the speed.
    clocks : Clocks

    Attributes
    ----------
    speed : float
        Seconds of the motion in a second.
    loop : bool
        Whether the end is followed by the beginning.
    finished : int
        How often the end was reached.
    """

    def __init__(self, rate_hz: float, clocks: Clocks) -> None:
        self.rate_hz = rate_hz
        self.speed = 1.0
        self.loop = False
        self.finished = 0
        self.duration_s = 0.0
        self._clocks = clocks
        self.rewind()

    @property
    def playing(self) -> bool:
        """Whether frames are due one after the other."""
        return self._stretch is not None

    def load(self, duration_s: float) -> None:
        """Take a motion of this duration [s], at its beginning, and stop."""
        self.duration_s = duration_s
        self.rewind()

    def rewind(self) -> None:
        """Stop and go back to the beginning."""
        self._stretch: _Stretch | None = None
        self._shown_at: tuple[float, int] | None = None
        self._number = 0
        self._at_end = False
        self.position_s = 0.0

    def play(self) -> None:
        """Go on from here, or from the beginning where this is the end; what plays already goes on undisturbed."""
        if self._stretch is None:
            if self._at_end or self.position_s >= self.duration_s:
                self.rewind()
            self._shown_at = None
            self._stretch = _Stretch(self._clocks.monotonic(), self._clocks.wall_ns(), self.position_s)

    def pause(self) -> None:
        """Stay where the last frame was, or at a place that was sought since: its frame is due at once."""
        self._stretch = None

    def seek(self, position_s: float) -> None:
        """Go to a place of the motion; where nothing plays, its frame is due at once.

        Raises
        ------
        ConfigError
            If it is not within the motion.
        """
        if not 0.0 <= position_s <= self.duration_s:
            raise ConfigError(f"position_s is {position_s:.9g}, expected 0 to {self.duration_s:.9g}")
        self.position_s, self._at_end = position_s, False
        self._shown_at = (self._clocks.monotonic(), self._clocks.wall_ns())
        if self._stretch is not None:
            self._stretch = self._from_next(position_s)

    def step(self, frames: int) -> None:
        """Pause, and go a number of frames on or back, at the most to an end."""
        self.pause()
        place = self.position_s + frames / self.rate_hz
        self.seek(min(max(place, 0.0), self.duration_s))

    def set_speed(self, speed: float) -> None:
        """Play faster or slower from the next frame on.

        Raises
        ------
        ConfigError
            If it is out of range.
        """
        if not MIN_SPEED <= speed <= MAX_SPEED:
            raise ConfigError(f"speed is {speed:g}, expected {MIN_SPEED:g} to {MAX_SPEED:g}")
        if self._stretch is not None:
            self._stretch = self._from_next(self._place(self._stretch.k))
        self.speed = speed

    def deadline_s(self) -> float | None:
        """Return when the next frame is due on the monotonic clock, None where none is."""
        if self._stretch is not None:
            return self._stretch.start_s + self._stretch.k / self.rate_hz
        return None if self._shown_at is None else self._shown_at[0]

    def take_due(self) -> Due | None:
        """Return the frame that is due, or None while none is."""
        deadline_s = self.deadline_s()
        if deadline_s is None or self._clocks.monotonic() < deadline_s:
            return None
        number, self._number = self._number, self._number + 1
        shown_at, self._shown_at = self._shown_at, None
        if self._stretch is None:
            assert shown_at is not None  # else nothing was due
            return Due(number, self.position_s, shown_at[1])
        stretch, k = self._stretch, self._stretch.k
        t0_ns = stretch.start_ns + round(k * 1e9 / self.rate_hz)
        self.position_s = min(self._place(k), self.duration_s)
        stretch.k += 1
        if self._place(stretch.k) > self.duration_s + _ROUNDING / self.rate_hz:
            self._end()
        return Due(number, self.position_s, t0_ns)

    def upcoming(self, n_frame: int) -> Floats:
        """Return the places of the next frames, as `take_due` will have them if nothing is changed, (k,) [s]."""
        if self._stretch is None:
            return np.array([self.position_s])
        places = np.array([self._place(self._stretch.k + i) for i in range(n_frame)])
        ahead = places <= self.duration_s + _ROUNDING / self.rate_hz
        return np.asarray(np.minimum(places[ahead], self.duration_s), dtype=np.float64)

    def _end(self) -> None:
        self.finished += 1
        if self.loop:
            self._stretch = self._from_next(0.0)
            self._number = 0
        else:
            self._stretch, self._at_end = None, True

    def _place(self, k: int) -> float:
        assert self._stretch is not None  # frames at an even pace are those of a stretch
        return self._stretch.position_s + k * self.speed / self.rate_hz

    def _from_next(self, position_s: float) -> _Stretch:
        """Return a stretch that begins at a place, with the next frame of this one."""
        assert self._stretch is not None  # only what plays has a next frame
        ahead = self._stretch.k / self.rate_hz
        start_ns = self._stretch.start_ns + round(1e9 * ahead)
        return _Stretch(self._stretch.start_s + ahead, start_ns, position_s)
