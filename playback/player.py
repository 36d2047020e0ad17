"""What is being played, frame by frame."""

from collections import deque

import numpy as np

from arm.arm_file import format_arm
from arm.effects.effect_table import changed
from arm.kinematics import sensor_positions, tip_position
from arm.model import Arm
from playback.control_message import Request
from playback.playable import Frame
from playback.playhead import Clocks, Due, Playhead
from playback.source import Source
from playback.trajectory import Floats, Trajectory

#: Frames that are computed in one go.
_AHEAD = 32
#: Rows of the overview of a motion at the most.
_OVERVIEW = 2000


class Player:
    """Plays a source's trials, and beside each its twin's where there is one.

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

    waits_on = None

    def __init__(self, source: Source, rate_hz: float, clocks: Clocks, trial: int | None = None) -> None:
        self.source = source
        self.head = Playhead(rate_hz, clocks)
        self._ahead: deque[tuple[float, Frame]] = deque()
        self.load(trial)

    @property
    def name(self) -> str:
        """What subscribers see as the source of the motion."""
        return self.source.name

    @property
    def arm(self) -> Arm:
        """The arm that moves."""
        return self.source.arm

    @property
    def playing(self) -> bool:
        """Whether frames are due one after the other."""
        return self.head.playing

    @property
    def finished(self) -> int:
        """How many times a trial was played to its end."""
        return self.head.finished

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
        number = self.source.trials[0] if trial is None else trial
        other = self.source.twin
        twin = None if other is None else (other, other.load(number))
        self._motion: Trajectory = motion
        self._twin: tuple[Source, Trajectory] | None = twin
        self._trial = number
        self._ahead.clear()
        self.head.load(motion.duration_s)
        self._frames(np.zeros(1))  # loads the compiled kernels, which would make the first frames late

    def play(self) -> None:
        """Go on, at the end from the beginning; what plays already goes on undisturbed."""
        self.head.play()

    def stop(self) -> None:
        """Stop and go back to the beginning."""
        self.head.rewind()

    def deadline_s(self) -> float | None:
        """Return when the next frame is due on the monotonic clock, None while none is."""
        return self.head.deadline_s()

    def take_due(self) -> Frame | None:
        """Return the fields of the frame that is due, or None while none is.

        ``tip`` and ``points`` come from the arm's geometry at the joint angles. A playback has no
        accelerometers, so ``points`` is not dead reckoning here, as it is in `limb/frames`.
        """
        due = self.head.take_due()
        if due is None:
            return None
        if not self._ahead or self._ahead[0][0] != due.position_s:
            self._compute(np.array([due.position_s]))
        return self._stamped(self._ahead.popleft()[1], due)

    def prepare(self) -> None:
        """Compute frames that will be due, so that none has to wait for it."""
        if self.head.playing and not self._ahead:
            self._compute(self.head.upcoming(_AHEAD))

    def state(self) -> dict[str, object]:
        """Return the whole state, in plain values."""
        head = self.head
        return {
            "playing": head.playing,
            "trial": self._trial,
            "position_s": head.position_s,
            "duration_s": head.duration_s,
            "rate_hz": head.rate_hz,
            "speed": head.speed,
            "loop": head.loop,
            "source": self.source.name,
            "arm": self.source.arm.name,
            "twin": self.source.twin is not None,
            "live": False,
            "q": self._motion.at(np.array([head.position_s]))[0][0].tolist(),
            "trials": list(self.source.trials),
            "finished": head.finished,
        }

    def carry_out(self, request: Request) -> dict[str, object]:
        """Do what a request says; return what its reply has beside the state.

        Raises
        ------
        LimbcalError
            If that cannot be done; nothing has changed then.
        """
        value = request.value
        match request.cmd:
            case "play":
                self.play()
            case "pause":
                self.head.pause()
            case "stop":
                self.stop()
            case "seek" if value is not None:
                self.head.seek(float(value))
            case "speed" if value is not None:
                self.head.set_speed(float(value))
            case "loop":
                self.head.loop = bool(value)
            case "step" if value is not None:
                self.head.step(int(value))
            case "load" if value is not None:
                self.load(int(value))
            case "list":
                durations = sorted(self.source.durations_s.items())
                return {"trials": [{"trial": trial, "duration_s": length} for trial, length in durations]}
            case "arm":
                twin = self.source.twin
                return {"arm": format_arm(self.arm), "twin": None if twin is None else format_arm(twin.arm)}
            case "motion":
                return {"motion": self._overview()}
        return {}

    def _overview(self) -> dict[str, object]:
        """Return the whole trial in few rows, for a time line."""
        n_frame = int(self._motion.duration_s * self.head.rate_hz) + 1
        t = np.linspace(0.0, self._motion.duration_s, min(max(n_frame, 2), _OVERVIEW))
        q = self._motion.at(t)[0]
        overview: dict[str, object] = {"t": t, "q": q, "tip": tip_position(changed(self.arm), q)}
        if self._twin is None:
            return {**overview, "twin_q": None, "twin_tip": None}
        twin, motion = self._twin
        q = motion.at(t)[0]
        return {**overview, "twin_q": q, "twin_tip": tip_position(changed(twin.arm), q)}

    def _compute(self, places: Floats) -> None:
        self._ahead = deque(zip(places.tolist(), self._frames(places), strict=True))

    def _frames(self, places: Floats) -> list[Frame]:
        """Return the frames at places of the motion, (k,) [s], all but their numbers and stamps."""
        rows = _moved(self.arm, self._motion, places)
        beside = None
        if self._twin is not None:
            twin, motion = self._twin
            beside = twin.name, _moved(twin.arm, motion, places)
        frames: list[Frame] = []
        for k, place in enumerate(places.tolist()):
            before = place - self.head.speed / self.head.rate_hz
            frame: Frame = {name: values[k : k + 1] for name, values in rows.items()}
            frame["gap"] = self._motion.gap_between(before, place)
            if beside is not None:
                whose, moved = beside
                frame["twin"] = {"name": whose, **{name: values[k : k + 1] for name, values in moved.items()}}
            frames.append(frame)
        return frames

    def _stamped(self, frame: Frame, due: Due) -> Frame:
        return {
            "frame0": due.number,
            "t0_ns": due.t0_ns,
            "dt_s": 1.0 / self.head.rate_hz,
            "n": 1,
            "method": self._motion.method,
            **frame,
            "source": self.source.name,
            "speed": self.head.speed,
            "trial": self._trial,
            "position_s": due.position_s,
        }


def _moved(arm: Arm, motion: Trajectory, places: Floats) -> dict[str, Floats]:
    q, dq, ddq = motion.at(places)
    arm = changed(arm)
    return {"q": q, "dq": dq, "ddq": ddq, "tip": tip_position(arm, q), "points": sensor_positions(arm, q)}
