"""`limbplay send`: one request to a playback that is running."""

import argparse
from collections.abc import Mapping
from pathlib import Path

import zmq

from limbcal.command import emit, show, to_json
from limbcal.errors import ConfigError
from playback.client import ask
from playback.control_message import COMMANDS, DEFAULT_CONTROL, Request, Value
from protocol.curve import load_client_key

#: When an answer is given up [ms].
TIMEOUT_MS = 5000
#: The option that goes with a command.
_OPTIONS = {"load": "trial", "seek": "position", "speed": "speed", "loop": "loop", "step": "frames"}

#: As it stands in the help.
EXAMPLE = "limbplay send pause"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay send` takes."""
    parser.add_argument("cmd", choices=tuple(COMMANDS), metavar="COMMAND", help=", ".join(COMMANDS))
    parser.add_argument("--trial", type=int, metavar="N", help="load: the trial")
    parser.add_argument("--position", type=float, metavar="S", help="seek: the place, in seconds")
    parser.add_argument("--speed", type=float, metavar="X", help="speed: 0.1 to 10")
    parser.add_argument("--loop", choices=("on", "off"), help="loop: whether the end is followed by the beginning")
    parser.add_argument("--frames", type=int, metavar="N", help="step: N frames on, or back if below 0 (1)")
    parser.add_argument(
        "--control", default=DEFAULT_CONTROL, metavar="E", help=f"where playback listens ({DEFAULT_CONTROL})"
    )
    parser.add_argument("--key", type=Path, metavar="FILE", help="client's key, where playback asks for one")
    parser.set_defaults(action=send)


def send(arguments: argparse.Namespace) -> None:
    """Print the reply; one that says no is an error."""
    request = Request(arguments.cmd, _value(arguments))
    key = None if arguments.key is None else load_client_key(arguments.key)
    with zmq.Context() as context:
        reply = ask(context, arguments.control, request, TIMEOUT_MS, key)
    if arguments.json:
        emit(to_json(reply))
    if not reply["ok"]:
        raise ConfigError(f"playback refused {arguments.cmd}: {reply.get('error')}")
    if not arguments.json:
        show(_words(reply))


def _value(arguments: argparse.Namespace) -> Value | None:
    """Return what goes with the request."""
    given = {option: getattr(arguments, option) for option in _OPTIONS.values()}
    mine = _OPTIONS.get(arguments.cmd)
    for option, value in given.items():
        if value is not None and option != mine:
            owner = next(cmd for cmd, of_it in _OPTIONS.items() if of_it == option)
            raise ConfigError(f"{arguments.cmd}: --{option} goes with {owner}, and only with it")
    if mine is None:
        return None
    value = given[mine]
    if mine == "loop":
        return bool(value != "off")
    if value is None and mine == "frames":
        return 1
    if value is None:
        raise ConfigError(f"{arguments.cmd}: --{mine} goes with {arguments.cmd}, and is missing")
    field = COMMANDS[arguments.cmd]
    if field is not None and not field.fits(value):
        raise ConfigError(f"{arguments.cmd}: --{mine} is {value}, expected {field.words}")
    number: Value = value
    return number


def _words(reply: Mapping[str, object]) -> str:
    """Return one ``name: value`` a line, those of a nested map behind its name."""
    lines = []
    for name, value in reply.items():
        inner = value.items() if isinstance(value, Mapping) else [("", value)]
        lines += [f"{name} {key}: {item}" if key else f"{name}: {item}" for key, item in inner]
    return "\n".join(line for line in lines if not line.startswith("v:"))
