"""The loop of `fitter subscribe`: messages first, generations while there are none."""

import time
from collections.abc import Mapping
from typing import Any, TypedDict

from rich.live import Live

from fitter.live.calibration import Calibration
from fitter.live.complete_stream import CompleteStream
from fitter.live.live_table import live_table
from fitter.live.progress_message import dynamics_fields, kinematics_fields
from fitter.live.stream import MotionAssembler
from fitter.live.stream_account import StreamAccount
from limbcal.command import console, say, say_notes
from limbcal.errors import DataError
from limbcal.note import of_source
from protocol.message import DYNAMICS, HEALTH, KINEMATICS
from protocol.publisher import Publisher


class Trials(TypedDict):
    """Motions that were used, motions that were made, and the time of frames that are missing [s]."""

    learn: int
    evaluate: int
    expected: int
    lost_s: float


#: Generations bred between messages, messages taken in one go, and how often the table and messages are renewed.
_LITTER, _DRAUGHT = 5, 50
_RENEW_S = 0.25
#: How long to wait for a message at a time.
_WAIT_MS = 50


class Session:
    """Follows a stream and calibrates the arm; publishes what is known so far.

    Parameters
    ----------
    calibration : Calibration
    publisher : Publisher
    stream : CompleteStream

    Attributes
    ----------
    calibration : Calibration
    account : StreamAccount
    left_out : int
        Motions that could not be used.
    """

    def __init__(self, calibration: Calibration, publisher: Publisher, stream: CompleteStream) -> None:
        self.calibration = calibration
        self.account = StreamAccount()
        self.left_out = 0
        self._publisher = publisher
        self._stream = stream
        self._assembler = MotionAssembler()
        self._renewed = -_RENEW_S
        self._began = time.monotonic()
        self._vain_s = 0.0

    def follow(self, seconds: float | None, trials: int | None, idle: float | None) -> None:
        """Follow the stream for a time, or a number of motions, or until it idles, or until interrupted.

        It idles when the arm has rested for this time by the stream's own clock, or when this time was waited for
        frames in vain: never while messages wait or something is being learnt, however long that takes.
        """
        with Live(console=console, transient=True, auto_refresh=False) as live:
            while not self._over(seconds, trials, idle):
                bred = any([self.calibration.breed() for _ in range(_LITTER)])
                for _ in range(1 if bred else _DRAUGHT):  # a stream without a pause must not hold up the rest
                    if not self._receive(0 if bred else _WAIT_MS) or self._has(trials):
                        break
                if time.monotonic() - self._renewed >= _RENEW_S:
                    self._renewed = time.monotonic()
                    self._publish()
                    missed = sum(self._stream.missed.values())
                    live.update(live_table(self.calibration, self._assembler, missed), refresh=True)

    def listen(self) -> None:
        """Tell those who wait for it that what is sent from now on is received."""
        self._publish()

    def conclude(self) -> None:
        """Learn from all motions that there were, and tell what is final."""
        self.calibration.conclude()
        self._publish_dynamics()
        self._publish()

    @property
    def motions(self) -> int:
        """Motions that are learnt from or kept for evaluation."""
        return len(self.calibration.learn) + len(self.calibration.evaluate)

    def report(self) -> dict[str, object]:
        """Return what is to be said of the stream itself."""
        return {
            "frames": self.account.frames,
            "motions": self.motions,
            "missed_messages": sum(self._stream.missed.values()),
            "recovered_messages": self._stream.recovered,
            "daemon_restarts": self._stream.restarts,
        }

    def trials(self, expected: int | None) -> Trials:
        """Return the motions that were used, those that were made, and the time of frames that are missing.

        Parameters
        ----------
        expected : int, optional
            How many were to be made; unless given, as many as the daemon announced.
        """
        return {
            "learn": len(self.calibration.learn),
            "evaluate": len(self.calibration.evaluate),
            "expected": self.account.made if expected is None else expected,
            "lost_s": self.account.lost_s,
        }

    def _over(self, seconds: float | None, trials: int | None, idle: float | None) -> bool:
        if self._has(trials):
            return True
        if seconds is not None and time.monotonic() - self._began >= seconds:
            self._stream.stop()
            return not self._stream.waits  # what had come by then counts
        if idle is None or not self.account.made or self._stream.waits:
            return False
        return self._vain_s >= idle or (not self.account.moving and self.account.rested_s >= idle)

    def _has(self, trials: int | None) -> bool:
        return trials is not None and self.motions + self.left_out >= trials

    def _receive(self, timeout_ms: int) -> bool:
        """Take the next message if there is one; only time that was really spent waiting for one was in vain."""
        message = self._stream.receive(timeout_ms)
        if message is None:
            self._vain_s += 1e-3 * timeout_ms
            return False
        self.take(*message)
        return True

    def take(self, topic: str, fields: Mapping[str, Any]) -> None:
        """Take in a message, and learn from the motion that it completes.

        Raises
        ------
        ProtocolError
            If a field is missing or does not fit.
        """
        if topic != HEALTH:
            self._vain_s = 0.0
        self.account.take(topic, fields)
        motion = self._assembler.feed(topic, fields)
        if motion is None:
            return
        try:
            trial = self.calibration.add(motion)
        except DataError as error:
            self.left_out += 1
            say(f"{motion.name} is left out: {error}")
            return
        say_notes(of_source(trial.notes, trial.name))
        if trial.role == "evaluate":
            say(f"{trial.name}: {trial.t[-1]:.2f} s, kept for evaluation")
            return
        self.calibration.learn_dynamics()
        self._publish_dynamics()
        doubt = f"; {self.calibration.doubt}" if self.calibration.doubt else ""
        say(f"{trial.name}: {trial.t[-1]:.2f} s, learnt from{doubt}")

    def _publish_dynamics(self) -> None:
        if self.calibration.dynamics is not None and not self.calibration.doubt:
            self._publisher.publish(DYNAMICS, dynamics_fields(self.calibration))

    def _publish(self) -> None:
        if self.calibration.geometry.samples:
            self._publisher.publish(KINEMATICS, kinematics_fields(self.calibration))
        uptime_s = time.monotonic() - self._began
        self._publisher.publish(HEALTH, {"last_seq": dict(self._publisher.last_seq), "uptime_s": uptime_s})
