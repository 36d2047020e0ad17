"""`limbd status`."""

import argparse
from pathlib import Path

from daemon.commands.options import DEFAULT_ENDPOINT, not_negative

#: As it stands in the help.
EXAMPLE = "limbd status --once"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add = parser.add_argument
    add("--endpoint", default=DEFAULT_ENDPOINT, metavar="E", help=f"default {DEFAULT_ENDPOINT}")
    add("--key", type=Path, metavar="FILE", help="NAME.limbkey, where the daemon asks for one")
    add("--once", action="store_true", help="one report and no more")
    add("--wait-s", type=not_negative, metavar="S", help="how long to wait for a daemon (default 30)")
    parser.set_defaults(action=show)


def show(arguments: argparse.Namespace) -> None:
    """Show how a daemon is doing."""
    from daemon.monitoring.status_view import WAIT_S, status

    wait_s = WAIT_S if arguments.wait_s is None else arguments.wait_s
    status(arguments.endpoint, arguments.key, arguments.once, arguments.json, wait_s)
