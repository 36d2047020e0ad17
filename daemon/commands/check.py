"""`limbd check`: a config, or an arm file by itself."""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

from limbcal.command import ask, emit, show
from limbcal.errors import ConfigError
from limbcal.note import documents

#: As it stands in the help.
EXAMPLE = "limbd check arm.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.set_defaults(action=check)


def check(arguments: argparse.Namespace) -> Mapping[str, object]:
    """List every mistake in a config or an arm file, and what is possible and hardly meant."""
    from arm.questions import questions_of
    from daemon.config.checked_file import arm_and_source

    try:
        kind, arm, source = arm_and_source(arguments.file)
    except ConfigError as error:
        if arguments.json:
            emit(json.dumps({"file": str(arguments.file), "ok": False, "mistakes": error.mistakes}))
        raise
    questions = questions_of(arm, source)
    ask(questions)
    doubts = f", {len(questions)} to be looked at" if questions else ""
    show(f"{arguments.file}: no mistakes{doubts}")
    return {
        "file": str(arguments.file),
        "ok": True,
        "kind": kind,
        "mistakes": [],
        "arm": arm.name,
        "notes": documents(questions),
    }
