"""The door of every command: exit codes, `--json`, `--debug`, and a clean stop on a signal."""

import argparse
import json
import math
import os
import shlex
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from types import FrameType

from rich.console import Console, RenderableType

from limbcal.errors import DeviceError, LimbcalError
from limbcal.escaped import escaped
from limbcal.note import Note, documents, sentences


class _Stdout(Console):
    def on_broken_pipe(self) -> None:
        """Leave a reader that is gone to `show`, in place of ending the process."""
        raise  # noqa: PLE0704 - what is being handled where this is called


#: Progress, warnings and errors go to stderr; stdout belongs to the answer.
console = Console(stderr=True, highlight=False)
_stdout = _Stdout(highlight=False)
#: Where the answer goes that a person reads: stdout, unless that belongs to a JSON document.
_answers: ContextVar[Console] = ContextVar("answers", default=_stdout)
#: What is being carried out, as it was typed.
_command_line: ContextVar[str] = ContextVar("command_line", default="")
#: What was questioned in what the command was given.
_asked: ContextVar[tuple[Note, ...]] = ContextVar("asked", default=())

Document = Mapping[str, object]
Action = Callable[[argparse.Namespace], Document | None]


def emit(text: str) -> None:
    """Write an answer to stdout.

    Raises
    ------
    DeviceError
        If nobody can take it: the disk is full, the reader gone.
    """
    with _writable():
        sys.stdout.write(text + "\n")
        sys.stdout.flush()


def show(answer: RenderableType) -> None:
    """Write an answer that a person reads, a table or a sentence, to stdout; with ``--json`` to stderr.

    Raises
    ------
    DeviceError
        If nobody can take it: the disk is full, the reader gone.
    """
    with _writable():
        plain = isinstance(answer, str)  # a table may have its own markup
        answers().print(escaped(answer) if isinstance(answer, str) else answer, markup=not plain, soft_wrap=plain)
        answers().file.flush()


def answers() -> Console:
    """Return the console of `show`, for a live view of an answer."""
    return _answers.get()


def command_line() -> str:
    """Return the command that is being carried out, as it was typed; empty where none is."""
    return _command_line.get()


def say(sentence: str) -> None:
    """Write words for the person at the terminal to stderr; characters that cannot be printed are written out."""
    console.print(escaped(sentence), markup=False, soft_wrap=True)


def say_notes(notes: Iterable[Note]) -> None:
    """Write notes for the person at the terminal to stderr, each sentence once."""
    for sentence in sentences(notes):
        say(sentence)


def ask(notes: Iterable[Note]) -> None:
    """Question what a command was given: on stderr now, and among the ``notes`` of its document."""
    asked = tuple(notes)
    _asked.set((*_asked.get(), *asked))
    say_notes(asked)


def with_asked(document: Document) -> Document:
    """Return a document with what was questioned so far among its ``notes``, where it has them."""
    asked, notes = documents(_asked.get()), document.get("notes", [])
    if not asked or not isinstance(notes, list):
        return document
    return {**document, "notes": [*asked, *(note for note in notes if note not in asked)]}


@contextmanager
def _writable() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # or the rest of the buffer would fail again
        raise DeviceError(f"stdout cannot be written: {error.strerror}") from error


def to_json(document: object) -> str:
    """Return strict JSON; what is not a finite number becomes null."""
    return json.dumps(_strict(document), indent=2, allow_nan=False)


def strict_line(document: object) -> str:
    """Return strict JSON in one line; what is not a finite number becomes null."""
    return json.dumps(_strict(document), allow_nan=False)


def _strict(value: object) -> object:
    if isinstance(value, Mapping):
        return {str(key): _strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_strict(item) for item in value]
    if hasattr(value, "tolist"):  # numpy arrays and scalars
        return _strict(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _stop(signum: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt(signal.Signals(signum).name)


def _failed(error: LimbcalError, as_json: bool) -> int:
    """Say what failed, print what there is all the same, and return the exit code."""
    for sentence in str(error).splitlines():
        say(f"error: {sentence}")
    if error.document is None or not as_json:
        return error.exit_code
    try:
        emit(to_json(with_asked(error.document)))
    except DeviceError as failure:
        return _failed(failure, False)
    return error.exit_code


def run_command(parser: argparse.ArgumentParser, argv: list[str] | None) -> int:
    """Parse the arguments, carry out the chosen action and return the exit code.

    The parser's namespace must hold ``action``, a function that takes the namespace and returns the JSON
    document of its answer, or None where there is nothing to print. SIGTERM is turned into KeyboardInterrupt
    so that one code path closes files and sockets; a stop that was asked for is a success. What `show` is given
    goes to stdout, or to stderr where that belongs to the document. An error that carries a document, such as
    `Unusable`, has it printed all the same.
    """
    arguments = sys.argv[1:] if argv is None else argv
    debug = "--debug" in arguments
    previous = signal.signal(signal.SIGTERM, _stop)
    namespace: argparse.Namespace | None = None
    _asked.set(())
    try:
        namespace = parser.parse_args(arguments)
        action: Action = namespace.action
        _answers.set(console if namespace.json else _stdout)
        _command_line.set(shlex.join([parser.prog, *arguments]))
        document = action(namespace)
        if document is not None and namespace.json:
            emit(to_json(with_asked(document)))
        return 0
    except KeyboardInterrupt:
        console.print("stopped")
        return 0
    except LimbcalError as error:
        if debug:
            console.print_exception()
        return _failed(error, namespace is not None and namespace.json)
    except MemoryError as error:
        if debug:
            console.print_exception()
        say(f"error: there is not enough memory for this ({error}); expected less data, or a lower rate")
        return DeviceError.exit_code
    finally:
        _answers.set(_stdout)
        _command_line.set("")
        _asked.set(())
        signal.signal(signal.SIGTERM, previous)
