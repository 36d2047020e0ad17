"""The door of every command: exit codes, `--json`, `--debug`, and a clean stop on a signal."""

import argparse
import json
import math
import os
import signal
import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from types import FrameType

from rich.console import Console

from limbcal.errors import ConfigError, DeviceError, LimbcalError

#: Words, tables and progress bars go to stderr; stdout belongs to the answer.
console = Console(stderr=True, highlight=False)

Document = Mapping[str, object]
Action = Callable[[argparse.Namespace], Document | None]


class Parser(argparse.ArgumentParser):
    """An argument parser whose mistakes join the error family."""

    #: The module whose ``add_arguments`` says what it takes, until it is asked.
    module: str | None = None

    def parse_known_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]
        """Parse as ever, but load the command only now that it was chosen."""
        if self.module is not None:
            module, self.module = self.module, None
            import_module(module).add_arguments(self)
        return super().parse_known_args(args, namespace)

    def error(self, message: str) -> "None":  # type: ignore[override]
        """Raise a `ConfigError` in place of printing a usage text and leaving."""
        raise ConfigError(f"{self.prog}: {message}")


def parser_of(prog: str, description: str, package: str, commands: Mapping[str, str]) -> Parser:
    """Return the parser of a program with commands, of which only the chosen one is loaded.

    Parameters
    ----------
    prog, description : str
    package : str
        Where each command has a module of its name, with ``add_arguments``.
    commands : mapping of str to str
        What each of them does, in a sentence.
    """
    parser = Parser(prog=prog, description=description)
    chosen = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=Parser)
    for name, sentence in commands.items():
        command = chosen.add_parser(name, help=sentence, description=sentence, parents=[common_options()])
        command.module = f"{package}.{name}"
    return parser


def common_options() -> Parser:
    """Return the parent parser with the options that every command has."""
    parent = Parser(add_help=False)
    parent.add_argument("--json", action="store_true", help="print one JSON document on stdout, nothing else")
    parent.add_argument("--debug", action="store_true", help="show the traceback of an error")
    return parent


def emit(text: str) -> None:
    """Write an answer to stdout.

    Raises
    ------
    DeviceError
        If nobody can take it: the disk is full, the reader gone.
    """
    try:
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
    except OSError as error:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # or the rest of the buffer would fail again
        raise DeviceError(f"stdout cannot be written: {error.strerror}") from error


def say(sentence: str) -> None:
    """Write words for the person at the terminal to stderr."""
    console.print(sentence, markup=False, soft_wrap=True)


def to_json(document: object) -> str:
    """Return strict JSON; what is not a finite number becomes null."""
    return json.dumps(_strict(document), indent=2, allow_nan=False)


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


def run_command(parser: argparse.ArgumentParser, argv: list[str] | None) -> int:
    """Parse the arguments, carry out the chosen action and return the exit code.

    The parser's namespace must hold ``action``, a function that takes the namespace and returns the JSON
    document of its answer, or None where there is nothing to print. SIGTERM is turned into KeyboardInterrupt
    so that one code path closes files and sockets; a stop that was asked for is a success.
    """
    arguments = sys.argv[1:] if argv is None else argv
    debug = "--debug" in arguments
    previous = signal.signal(signal.SIGTERM, _stop)
    try:
        namespace = parser.parse_args(arguments)
        action: Action = namespace.action
        document = action(namespace)
        if document is not None and namespace.json:
            emit(to_json(document))
        return 0
    except KeyboardInterrupt:
        console.print("stopped")
        return 0
    except LimbcalError as error:
        if debug:
            console.print_exception()
        for sentence in str(error).splitlines():
            say(f"error: {sentence}")
        return error.exit_code
    except MemoryError as error:
        if debug:
            console.print_exception()
        say(f"error: there is not enough memory for this ({error}); expected less data, or a lower rate")
        return DeviceError.exit_code
    finally:
        signal.signal(signal.SIGTERM, previous)
