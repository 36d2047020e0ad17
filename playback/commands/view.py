"""`limbplay view`: the arm in a browser, with its twin and the controls of what is played."""

import argparse
from importlib import import_module
from pathlib import Path

from limbcal.command import emit, show, to_json
from limbcal.errors import ConfigError
from playback.commands.serve import DEFAULT_ENDPOINT, DEFAULT_LIVE
from playback.commands.source_options import DEFAULT_ARM, add_source_arguments
from playback.control_message import DEFAULT_CONTROL

DEFAULT_PORT = 8780

#: As it stands in the help.
EXAMPLE = "limbplay view motions.npz --arm calibrated.toml --twin calibrated.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `limbplay view` takes."""
    add_source_arguments(parser)
    parser.add_argument(
        "--markers",
        nargs="+",
        type=Path,
        metavar="FILE",
        help="recordings (.c3d, .trc) that SOURCE was tracked from, one a trial, drawn beside the arm's",
    )
    parser.add_argument(
        "--live", nargs="?", const=DEFAULT_LIVE, metavar="E", help=f"show what a daemon publishes ({DEFAULT_LIVE})"
    )
    parser.add_argument("--trial", type=int, metavar="N", help="trial to load first, by default the lowest")
    parser.add_argument("--rate-hz", type=float, default=100.0, metavar="R", help="messages a second (100)")
    parser.add_argument("--play", action="store_true", help="start at once, without waiting for the button")
    parser.add_argument(
        "--touch",
        action="store_true",
        help="in place of SOURCE: simulate --arm at 1 kHz, to be pulled by its tip",
    )
    parser.add_argument(
        "--q0", type=_numbers, metavar="Q1,Q2,…", help="touch: where it rests, rad or m (all zero)"
    )
    parser.add_argument(
        "--connect",
        metavar="E",
        help=f"in place of SOURCE: a playback that runs already, by default the one on {DEFAULT_ENDPOINT}",
    )
    parser.add_argument("--control", metavar="E", help=f"where that one is controlled ({DEFAULT_CONTROL})")
    parser.add_argument("--key", type=Path, metavar="FILE", help="client's key, where it asks for one")
    parser.add_argument("--host", default="127.0.0.1", metavar="H", help="address of the page (127.0.0.1)")
    parser.add_argument(
        "--port", type=int, default=DEFAULT_PORT, metavar="P", help=f"port of the page ({DEFAULT_PORT}); 0: any"
    )
    parser.add_argument("--no-open", dest="open", action="store_false", help="open no browser")
    parser.set_defaults(action=view)


def _numbers(text: str) -> tuple[float, ...]:
    try:
        return tuple(map(float, text.split(",")))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"found {text!r}, expected numbers such as 0.4,0.9") from error


def view(arguments: argparse.Namespace) -> None:
    """Show the page until stopped."""
    kinds = {
        "source": arguments.source or arguments.reference,
        "--live": arguments.live,
        "--touch": arguments.touch or None,
        "--connect": arguments.connect or arguments.control,
    }
    given = [name for name, value in kinds.items() if value is not None]
    if len(given) > 1:
        raise ConfigError(f"{given[0]} and {given[1]} are both given: expected one thing to show")
    if arguments.markers and arguments.source is None:
        raise ConfigError("--markers is given without SOURCE: expected the motion that was tracked from them")
    if (arguments.q0 is not None) > arguments.touch:
        raise ConfigError("--q0 is given without --touch, which alone takes it")
    if arguments.touch and arguments.arm is None:
        arguments.arm = DEFAULT_ARM
    if not given or given == ["--connect"]:
        if arguments.connect is None:
            arguments.connect, arguments.control = DEFAULT_ENDPOINT, arguments.control or DEFAULT_CONTROL
    if not 0 <= arguments.port < 1 << 16:
        raise ConfigError(f"--port is {arguments.port}, expected 0 to 65535")
    names = ("source", "reference", "live", "arm", "twin", "trial", "columns", "rate_hz", "play", "key")
    arguments.playback = argparse.Namespace(
        **{name: getattr(arguments, name) for name in names}, keys=None, once=False
    )
    try:
        session = import_module("playback.view.session")
    except ModuleNotFoundError as error:
        if error.name != "viser":
            raise
        raise ConfigError(
            "limbplay view needs the package viser, which is not installed; pip install 'limbcal[view]' adds it"
        ) from error

    def announce(facts: dict[str, object]) -> None:
        if arguments.json:
            emit(to_json(facts))
        show(f"{facts['arm']}: page at {facts['url']}")

    session.run(arguments, announce)
