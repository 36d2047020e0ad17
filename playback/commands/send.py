"""`limbplay send`: one request to a playback that is running."""

import argparse
from collections.abc import Mapping

import zmq

from limbcal.command import emit, to_json
from limbcal.errors import ConfigError
from playback.client import ask
from playback.commands.serve import DEFAULT_CONTROL
from playback.control_message import COMMANDS, Request

TIMEOUT_MS = 5000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay send` takes."""
    parser.add_argument("cmd", choices=tuple(COMMANDS), metavar="CMD", help=", ".join(COMMANDS))
    parser.add_argument("--trial", type=int, metavar="N", help="the trial to load")
    parser.add_argument(
        "--control", default=DEFAULT_CONTROL, metavar="E", help=f"where playback listens ({DEFAULT_CONTROL})"
    )
    parser.set_defaults(action=send)


def send(arguments: argparse.Namespace) -> None:
    """Print the reply; one that says no is an error."""
    if (arguments.trial is not None) != (arguments.cmd == "load"):
        raise ConfigError(f"{arguments.cmd}: --trial goes with load, and only with it")
    with zmq.Context() as context:
        reply = ask(context, arguments.control, Request(arguments.cmd, arguments.trial), TIMEOUT_MS)
    if arguments.json:
        emit(to_json(reply))
    if not reply["ok"]:
        raise ConfigError(f"playback refused {arguments.cmd}: {reply.get('error')}")
    if not arguments.json:
        emit(_words(reply))


def _words(reply: Mapping[str, object]) -> str:
    """Return one ``name: value`` a line, those of a nested map behind its name."""
    lines = []
    for name, value in reply.items():
        inner = value.items() if isinstance(value, Mapping) else [("", value)]
        lines += [f"{name} {key}: {item}" if key else f"{name}: {item}" for key, item in inner]
    return "\n".join(line for line in lines if not line.startswith("v:"))
