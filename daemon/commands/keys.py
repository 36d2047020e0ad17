"""`limbd keys`."""

import argparse
from collections.abc import Mapping
from pathlib import Path

from limbcal.command import show

#: As it stands in the help.
EXAMPLE = "limbd keys new lab-pc --dir keys"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add = parser.add_argument
    add("what", choices=["new"], help="new: make a key for one more client")
    add("name", metavar="NAME")
    add("--dir", type=Path, default=Path("keys"), metavar="DIR", help="publish.keys (default keys)")
    add("--out", type=Path, metavar="FILE", help="what the client gets (default NAME.limbkey)")
    parser.set_defaults(action=keys)


def keys(arguments: argparse.Namespace) -> Mapping[str, object]:
    """Let one more client in."""
    from protocol.curve import new_client

    out = new_client(arguments.dir, arguments.name, arguments.out)
    show(f"{out}: give it to {arguments.name}; the daemon lets it in from its next start on")
    return {"client": arguments.name, "key": str(out), "keys": str(arguments.dir)}
