"""`fitter subscribe`: follow the daemon and calibrate the arm while it moves."""

import argparse
import time
import uuid
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import zmq

from arm.arm_file import preset_names
from fitter.commands.arm_option import questioned_arm
from fitter.commands.live_diagnosis import diagnosis_fields, live_diagnosis, write_live_diagnosis
from fitter.commands.options import at_least, positive
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.dynamics.usability import next_to_nothing
from fitter.live.calibration import Calibration
from fitter.live.complete_stream import CompleteStream
from fitter.live.session import Session
from fitter.live.warm_up import warm_up
from fitter.report.compared import Compared, load_compared
from limbcal.command import Document, console, say, say_notes
from limbcal.errors import ConfigError, DeviceError, LimbcalError, NotIdentifiable, Unusable
from limbcal.note import Note, documents
from protocol.curve import gate_of, load_client_key
from protocol.inbox import Inbox
from protocol.message import DIAGNOSIS, FRAMES, HEALTH, TRIAL
from protocol.publisher import Publisher
from protocol.subscriber import Subscriber

DEFAULT_CONNECT = "tcp://127.0.0.1:5770"
DEFAULT_ENDPOINT = "tcp://127.0.0.1:5771"

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
    parser.add_argument("--trials", type=at_least(1), metavar="N", help="stop after N motions; fewer are exit 4")
    parser.add_argument("--idle", type=positive, metavar="S", help="stop when the arm has rested for so long")
    parser.add_argument("--seed", type=at_least(0), default=0, help="of the genetic algorithms (0)")
    parser.add_argument("--compare", action="append", default=[], metavar="A", help="another arm to print beside")
    parser.add_argument("--diagnose", action="store_true", help="at the end, say why the simulation is wrong")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write the calibrated arm, JSON and a report here")
    parser.set_defaults(action=subscribe)


@dataclass
class _Followed:
    """How following a stream went."""

    session: Session
    compared: Sequence[Compared]
    notes: list[Note]
    stopped: bool = False
    trouble: LimbcalError | None = None
    diagnosis: Diagnosis | None = None


def subscribe(arguments: argparse.Namespace) -> Document | None:
    """Follow the stream until it is time to stop; write what was learnt, whatever ended it."""
    context = zmq.Context()
    try:
        with ExitStack() as stack:
            followed = _follow(arguments, context, stack)
    finally:
        context.destroy(linger=0)  # also what an interrupt left open
    document = _document(arguments, followed)
    if followed.trouble is not None:
        if followed.session.calibration.learnt:  # nothing learnt is lost, and nothing is no answer
            followed.trouble.document = document
        raise followed.trouble
    if followed.stopped:  # a stop that was asked for is a success, but what is missing is missing
        _shortfall(followed.session, None)
        return document
    shortcoming = _shortcoming(arguments, followed.session, document)
    if shortcoming is not None:
        shortcoming.document = document
        raise shortcoming
    return document


def _follow(
    arguments: argparse.Namespace, context: "zmq.Context[zmq.Socket[bytes]]", stack: ExitStack
) -> _Followed:
    arm = None if arguments.arm is None else questioned_arm(arguments.arm)
    compared = [] if arm is None else load_compared(arguments.compare, arm)
    if arguments.out is not None:
        _require_room(arguments.out)  # learning for an hour and then having no place to write would be a pity
    key = None if arguments.key is None else load_client_key(arguments.key)
    gate = stack.enter_context(gate_of(context, arguments.keys))
    subscriber = stack.enter_context(
        Subscriber(context, arguments.connect, (FRAMES, TRIAL, HEALTH), key, watched=True)
    )
    inbox = Inbox(subscriber)
    stack.callback(inbox.close)
    inbox.start()  # from here on nothing is lost, whatever takes its time: compiling, learning, diagnosing
    notes: list[Note] = []
    stream = CompleteStream(inbox, lambda note: _tell(note, notes), arm_name=None if arm is None else arm.name)
    stack.callback(stream.close)
    first = None
    if arm is None:
        name, first = _named(stream, arguments)
        arm = questioned_arm(name)
        compared = load_compared(arguments.compare, arm)
    run = str(uuid.uuid4())
    publisher = Publisher(context, arguments.endpoint, arm.name, run, gate, watched=True)
    stack.enter_context(publisher)
    warm_up()
    session = Session(Calibration(arm, arguments.seed), publisher, stream)
    followed = _Followed(session, compared, notes)
    say(f"following {arguments.connect}, publishing on {publisher.endpoint}; Ctrl-C to stop")
    session.listen()
    try:
        if first is not None:
            session.take(*first)
        session.follow(arguments.seconds, arguments.trials, arguments.idle)
    except KeyboardInterrupt:
        followed.stopped = True
        say("stopped")
    except LimbcalError as error:  # what was learnt until then is not lost
        followed.trouble = error
    stream.stop()
    try:
        session.conclude()
    except KeyboardInterrupt:
        followed.stopped = True
        say("stopped: written is what was known after the last motion")
        return followed
    if arguments.diagnose and session.calibration.learnt:
        followed.diagnosis = live_diagnosis(session.calibration)
        if followed.diagnosis is not None:
            publisher.publish(DIAGNOSIS, diagnosis_fields(followed.diagnosis))
    return followed


def _document(arguments: argparse.Namespace, followed: _Followed) -> dict[str, object]:
    """Write what was learnt; return it."""
    session, trials = followed.session, followed.session.trials(arguments.trials)
    document: dict[str, object] = {"stream": session.report()}
    rest: dict[str, object] = {"trials": trials, "notes": documents(followed.notes)}
    if followed.diagnosis is not None:
        rest["diagnosis"] = followed.diagnosis.finding.document()
    try:
        if session.calibration.learnt:
            from fitter.report.results import write_results

            document = write_results(
                session.calibration,
                followed.compared,
                session.report(),
                arguments.out,
                dict(trials),
                followed.notes,
            )
        if followed.diagnosis is not None and arguments.out is not None:
            write_live_diagnosis(followed.diagnosis, arguments.out)
    except LimbcalError as error:  # what cannot be written is still printed
        error.document = {**(error.document or document), **rest}
        raise
    return document | rest


def _shortcoming(
    arguments: argparse.Namespace, session: Session, document: Mapping[str, Any]
) -> LimbcalError | None:
    """Return why the answer is none, less than was asked for, or one that explains next to nothing."""
    if not session.calibration.learnt:
        return _nothing_learnt(arguments.connect, session)
    if (dynamics := document.get("dynamics")) is not None:
        reasons = next_to_nothing(dynamics["explained"], session.calibration.calibrated())
        if reasons:
            return Unusable([f"{arguments.connect}: {reason}" for reason in reasons])
    sentence = _shortfall(session, arguments.trials)
    return Unusable(f"{arguments.connect}: fewer motions came than were made, {sentence}") if sentence else None


def _shortfall(session: Session, expected: int | None) -> str:
    """Say in red how many motions and seconds are missing; return the sentence, empty where no motion is."""
    trials = session.trials(expected)
    if session.motions >= trials["expected"]:
        return ""
    sentence = (
        f"{session.motions} of {trials['expected']} motions were used ({trials['learn']} learnt from, "
        f"{trials['evaluate']} held back to evaluate), {trials['lost_s']:.3g} s of frames were lost or missed"
    )
    console.print(sentence, style="bold red", markup=False, soft_wrap=True)
    return sentence


def _tell(note: Note, notes: list[Note]) -> None:
    notes.append(note)
    say_notes([note])


def _require_room(path: Path) -> None:
    """Make a folder, and write there: some can be entered and take no file."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise DeviceError(f"{path}: nothing can be written there: {error.strerror}") from error


def _nothing_learnt(connect: str, session: Session) -> LimbcalError:
    frames = session.account.frames
    if not frames:
        return DeviceError(f"{connect}: nothing was received, expected the frames of a daemon")
    learning = len(session.calibration.learn)
    if not learning:
        return NotIdentifiable(
            f"{connect}: no learning motion ended in {frames} frames, expected the arm to move and rest"
        )
    return NotIdentifiable(f"{connect}: nothing was learnt of {learning} motion(s): {session.calibration.doubt}")


def _named(stream: CompleteStream, arguments: argparse.Namespace) -> tuple[str, tuple[str, dict[str, Any]]]:
    """Wait for the first message; return the built-in arm that it names, and the message."""
    deadline = None if arguments.seconds is None else time.monotonic() + arguments.seconds
    while deadline is None or time.monotonic() < deadline:
        if (message := stream.receive(100)) is not None:
            name = str(message[1].get("arm"))
            if name not in preset_names():
                raise ConfigError(
                    f"the stream is of arm {name!r}, which is not built in; expected --arm with its file"
                )
            return name, message
    raise DeviceError(f"{arguments.connect}: nothing was received in {arguments.seconds:g} s")
