"""`fitter subscribe`: follow the daemon and calibrate the arm while it moves."""

import argparse
import time
import uuid
from pathlib import Path

import zmq
from rich.live import Live

from arm.arm_file import load_arm, preset_names
from fitter.commands.live_diagnosis import diagnosis_fields, live_diagnosis, write_live_diagnosis
from fitter.commands.options import at_least, positive
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.live.calibration import Calibration
from fitter.live.live_table import live_table
from fitter.live.progress_message import dynamics_fields, kinematics_fields
from fitter.live.stream import MotionAssembler
from fitter.report.compared import load_compared
from fitter.report.results import write_results
from limbcal.command import Document, console, say, say_notes
from limbcal.errors import ConfigError, DataError, DeviceError, LimbcalError, NotIdentifiable
from limbcal.note import of_source
from protocol.curve import gate_of, load_client_key
from protocol.message import DIAGNOSIS, DYNAMICS, FRAMES, HEALTH, KINEMATICS, TRIAL
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber

DEFAULT_CONNECT = "tcp://127.0.0.1:5770"
DEFAULT_ENDPOINT = "tcp://127.0.0.1:5771"
#: Generations bred between messages, messages taken in one go, and how often the table and messages are renewed.
_LITTER, _DRAUGHT = 5, 50
_RENEW_S = 0.25

#: As it stands in the help.
EXAMPLE = "fitter subscribe --arm my-arm.toml --out calibrated"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter subscribe` takes."""
    parser.add_argument("--connect", default=DEFAULT_CONNECT, metavar="E", help=f"the daemon ({DEFAULT_CONNECT})")
    parser.add_argument(
        "--endpoint", default=DEFAULT_ENDPOINT, metavar="E", help=f"publish here ({DEFAULT_ENDPOINT})"
    )
    parser.add_argument("--key", type=Path, metavar="FILE", help="NAME.limbkey, where the daemon asks for one")
    parser.add_argument("--keys", type=Path, metavar="DIR", help="let in only whom `limbd keys new` lists here")
    parser.add_argument(
        "--arm", metavar="A", help="arm file, or built-in arm; by default the one the stream names"
    )
    parser.add_argument("--seconds", type=positive, metavar="S", help="stop after so long")
    parser.add_argument("--trials", type=at_least(1), metavar="N", help="stop after so many motions")
    parser.add_argument("--idle", type=positive, metavar="S", help="stop when no motion has ended for so long")
    parser.add_argument("--seed", type=at_least(0), default=0, help="of the genetic algorithms (0)")
    parser.add_argument("--compare", action="append", default=[], metavar="A", help="another arm to print beside")
    parser.add_argument("--diagnose", action="store_true", help="at the end, say why the simulation is wrong")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write the calibrated arm, JSON and a report here")
    parser.set_defaults(action=subscribe)


def subscribe(arguments: argparse.Namespace) -> Document | None:
    """Follow the stream until it is time to stop; write what was learnt, whatever ended it."""
    arm = None if arguments.arm is None else load_arm(arguments.arm)
    compared = [] if arm is None else load_compared(arguments.compare, arm)
    if arguments.out is not None:
        _make_directory(arguments.out)  # learning for an hour and then having no place to write would be a pity
    key = None if arguments.key is None else load_client_key(arguments.key)
    context = zmq.Context()
    try:
        with (
            gate_of(context, arguments.keys) as gate,
            Subscriber(context, arguments.connect, (FRAMES, TRIAL, HEALTH), key) as subscriber,
        ):
            if arm is None:
                arm = load_arm(_named(subscriber, arguments))
                compared = load_compared(arguments.compare, arm)
            with Publisher(context, arguments.endpoint, arm.name, str(uuid.uuid4()), gate) as publisher:
                session = _Session(Calibration(arm, arguments.seed), publisher, subscriber)
                say(f"following {arguments.connect}, publishing on {publisher.endpoint}; Ctrl-C to stop")
                stopped, trouble = False, None
                try:
                    session.follow(arguments.seconds, arguments.trials, arguments.idle)
                except KeyboardInterrupt:
                    stopped = True
                    say("stopped")
                except LimbcalError as error:  # what was learnt until then is not lost
                    trouble = error
                session.conclude()
                if arguments.diagnose and session.calibration.learnt:
                    session.diagnose()
    finally:
        context.destroy(linger=0)  # also what an interrupt left open
    if not session.calibration.learnt:
        if trouble is None and not stopped:
            trouble = _nothing_learnt(arguments.connect, session)
        if trouble is not None:
            raise trouble
        return {"stream": session.report()}
    document = write_results(session.calibration, compared, session.report(), arguments.out)
    if session.diagnosis is not None:
        document["diagnosis"] = session.diagnosis.finding.document()
        if arguments.out is not None:
            write_live_diagnosis(session.diagnosis, arguments.out)
    if trouble is not None:
        raise trouble
    return document


def _make_directory(path: Path) -> None:
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DeviceError(f"{path}: cannot be made a directory: {error.strerror}") from error


def _nothing_learnt(connect: str, session: "_Session") -> LimbcalError:
    if not session.frames:
        return DeviceError(f"{connect}: nothing was received, expected the frames of a daemon")
    learning = len(session.calibration.learn)
    if not learning:
        return NotIdentifiable(
            f"{connect}: no learning motion ended in {session.frames} frames, expected the arm to move and rest"
        )
    return NotIdentifiable(f"{connect}: nothing was learnt of {learning} motion(s): {session.calibration.doubt}")


def _named(subscriber: Subscriber, arguments: argparse.Namespace) -> str:
    """Wait for the first message and return the built-in arm that it names."""
    deadline = None if arguments.seconds is None else time.monotonic() + arguments.seconds
    while deadline is None or time.monotonic() < deadline:
        if (message := subscriber.receive(100)) is not None:
            name = str(message[1].get("arm"))
            if name not in preset_names():
                raise ConfigError(
                    f"the stream is of arm {name!r}, which is not built in; expected --arm with its file"
                )
            return name
    raise DeviceError(f"{arguments.connect}: nothing was received in {arguments.seconds:g} s")


class _Session:
    """The loop: messages first, generations while there are none."""

    def __init__(self, calibration: Calibration, publisher: Publisher, subscriber: Subscriber) -> None:
        self.calibration = calibration
        self.diagnosis: Diagnosis | None = None
        self._publisher = publisher
        self._subscriber = subscriber
        self._assembler = MotionAssembler()
        self._renewed = -_RENEW_S
        self._began = self._last_motion = time.monotonic()

    def follow(self, seconds: float | None, trials: int | None, idle: float | None) -> None:
        """Follow the stream for so long, or so many motions, or until it idles, or until interrupted."""
        with Live(console=console, transient=True, auto_refresh=False) as live:
            while not self._over(seconds, trials, idle):
                bred = any([self.calibration.breed() for _ in range(_LITTER)])
                for _ in range(1 if bred else _DRAUGHT):  # a stream without a pause must not hold up the rest
                    message = self._subscriber.receive(0 if bred else 50)
                    if message is None:
                        break
                    self._take(*message)
                if time.monotonic() - self._renewed >= _RENEW_S:
                    self._renewed = time.monotonic()
                    self._publish()
                    live.update(live_table(self.calibration, self._assembler, self._lost()), refresh=True)

    def conclude(self) -> None:
        """Learn from all motions that there were, and tell what is final."""
        self.calibration.conclude()
        self._publish_dynamics()
        self._publish()

    def diagnose(self) -> None:
        """Find out why the calibrated simulation is wrong, and tell it."""
        self.diagnosis = live_diagnosis(self.calibration)
        if self.diagnosis is not None:
            self._publisher.publish(DIAGNOSIS, diagnosis_fields(self.diagnosis))

    def _over(self, seconds: float | None, trials: int | None, idle: float | None) -> bool:
        now = time.monotonic()
        return (
            (seconds is not None and now - self._began >= seconds)
            or (trials is not None and self._motions() >= trials)
            or (idle is not None and self._motions() > 0 and now - self._last_motion >= idle)
        )

    @property
    def frames(self) -> int:
        """Frames received."""
        return self._assembler.frames

    def report(self) -> dict[str, object]:
        """Return what is to be said of the stream itself."""
        return {
            "frames": self.frames,
            "motions": self._motions(),
            "missed_messages": self._lost(),
            "daemon_restarts": self._subscriber.restarts,
        }

    def _motions(self) -> int:
        return len(self.calibration.learn) + len(self.calibration.evaluate)

    def _lost(self) -> int:
        return sum(self._subscriber.missed.values())

    def _take(self, topic: str, fields: dict[str, object]) -> None:
        motion = self._assembler.feed(topic, fields)
        if motion is None:
            return
        self._last_motion = time.monotonic()
        try:
            trial = self.calibration.add(motion)
        except DataError as error:
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
