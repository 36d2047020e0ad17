"""`limbd check`."""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

from limbcal.command import emit, show
from limbcal.errors import ConfigError

#: As it stands in the help.
EXAMPLE = "limbd check limbd.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.set_defaults(action=check)


def check(arguments: argparse.Namespace) -> Mapping[str, object]:
    """List every mistake in a config."""
    from daemon.config import load_setup

    try:
        setup = load_setup(arguments.file, {})
    except ConfigError as error:
        if arguments.json:
            emit(json.dumps({"file": str(arguments.file), "ok": False, "mistakes": error.mistakes}))
        raise
    show(f"{arguments.file}: no mistakes")
    return {"file": str(arguments.file), "ok": True, "mistakes": [], "arm": setup.arm.name}
