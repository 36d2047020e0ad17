"""`limbd run`."""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from daemon.commands.options import DEFAULT_ENDPOINT, add_device_options, given, positive
from limbcal.command import ask, console, emit
from limbcal.errors import ConfigError

#: As it stands in the help.
EXAMPLE = "limbd run --port /dev/ttyUSB0 --arm my-arm.toml --record recordings"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_device_options(parser)
    parser.add_argument("--wait", action="store_true", help="wait for a device that is not there yet")
    parser.add_argument("--method", metavar="M", help="how motion is tracked: filter (default) or integrate")
    parser.add_argument("--endpoint", metavar="E", help=f"where to publish (default {DEFAULT_ENDPOINT})")
    parser.add_argument("--record", metavar="DIR", help="record into this directory")
    parser.add_argument("--replay", type=Path, metavar="FILE", help="play a recording in place of a device")
    parser.add_argument("--speed", type=positive, default=1.0, metavar="X", help="of --replay: times as fast")
    parser.set_defaults(action=run)


def run(arguments: argparse.Namespace) -> None:
    """Acquire, track, publish and record."""
    from arm.questions import questions_of
    from daemon.config.config import load_setup, replayed_setup
    from daemon.monitoring.metrics import Metrics
    from daemon.monitoring.progress import Progress
    from daemon.process.stop_signal import StopSignal
    from daemon.service.supervisor import Supervisor

    if arguments.replay is None:
        setup = load_setup(arguments.config, given(arguments))
    else:
        _no_device(arguments)
        setup = replayed_setup(arguments.replay, given(arguments), arguments.speed)
    ask(questions_of(setup.arm, setup.config.arm.file))
    metrics = setup.config.metrics
    with (
        StopSignal() as stop,
        Progress(console) as progress,
        Metrics(None if metrics is None else metrics.address) as served,
    ):

        def started(announced: Mapping[str, object]) -> None:
            progress.started(announced)
            if arguments.json:
                emit(json.dumps(announced))

        def health(fields: Mapping[str, Any]) -> None:
            progress.health(fields)
            served.tell(fields)

        Supervisor(setup, stop, started, health, progress.trouble, wait=arguments.wait).run()


def _no_device(arguments: argparse.Namespace) -> None:
    given_too = [f"--{name}" for name in ("port", "baud", "config") if getattr(arguments, name) is not None]
    if given_too:
        raise ConfigError(f"--replay has its own device and config: expected no {' and no '.join(given_too)}")
