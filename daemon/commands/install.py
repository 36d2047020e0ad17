"""`limbd install`."""

import argparse
from collections.abc import Mapping
from pathlib import Path

#: As it stands in the help.
EXAMPLE = "limbd install --dry-run"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add = parser.add_argument
    add("--prefix", type=Path, default=Path("/"), metavar="DIR", help="root to install under")
    add("--dry-run", action="store_true", help="only say what would be done")
    add("--remove", action="store_true", help="take away what was laid down; configs stay")
    parser.set_defaults(action=install)


def install(arguments: argparse.Namespace) -> Mapping[str, object]:
    """Lay the service's files down, or take them away."""
    from daemon.service.installation import install as installed

    return installed(arguments.prefix, arguments.dry_run, arguments.remove)
