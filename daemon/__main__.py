"""`limbd`: the acquisition service and the virtual device."""

import argparse
import json
import math
import sys
from collections.abc import Mapping
from pathlib import Path

from limbcal.command import Parser, common_options, console, emit, run_command
from limbcal.errors import ConfigError

# What a subcommand needs is imported where it runs: every process of `limbd run` loads this module first, and
# only one of them has a use for the tracker's compiler.
# ruff: noqa: PLC0415

#: Of `limbd zero`: a few stretches to compare, and what is kept in memory.
_SHORTEST_S, _LONGEST_S = 0.5, 60.0

_FLAGS = {
    "port": ("device", "port"),
    "baud": ("device", "baud"),
    "arm": ("arm", "file"),
    "method": ("tracking", "method"),
    "endpoint": ("publish", "endpoint"),
    "record": ("record", "directory"),
}


def main(argv: list[str] | None = None) -> int:
    """Run `limbd`; return its exit code."""
    return run_command(_parser(), argv)


def _parser() -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = Parser(
        prog="limbd", description="Reads accelerometers from a serial port, tracks the arm, streams it."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    common = common_options()

    run = commands.add_parser("run", parents=[common], help="acquire, track, publish and record until stopped")
    _add_device_options(run)
    run.add_argument("--method", metavar="M", help="how motion is tracked: filter (default) or integrate")
    run.add_argument("--endpoint", metavar="E", help="where to publish (default tcp://127.0.0.1:5770)")
    run.add_argument("--record", metavar="DIR", help="record into this directory")
    run.set_defaults(action=_run)

    check = commands.add_parser("check", parents=[common], help="list every mistake in a config file")
    check.add_argument("file", type=Path, metavar="FILE")
    check.set_defaults(action=_check)

    zero = commands.add_parser(
        "zero", parents=[common], help="measure the sensors' biases while the arm rests at initial_q_rad"
    )
    _add_device_options(zero)
    zero.add_argument("--seconds", type=_seconds, default=2.0, metavar="S", help="how long to measure (default 2)")
    zero.add_argument("--out", type=Path, metavar="FILE", help="where the arm goes (default: its own file)")
    zero.set_defaults(action=_zero)

    virtual = commands.add_parser("virtual", parents=[common], help="be a device: the virtual arm on a pty")
    virtual.add_argument("--link", type=Path, metavar="PATH", help="make a symbolic link to the port")
    virtual.add_argument("--arm", default="dd-arm", metavar="A", help="arm file or built-in arm (default dd-arm)")
    virtual.add_argument("--seed", type=_whole, default=0, metavar="N", help="draws motions and sensors' errors")
    virtual.add_argument("--rate-hz", type=_positive, default=32000.0, metavar="R", help="default 32000")
    virtual.add_argument("--speed", type=_positive, default=1.0, metavar="X", help="times faster than real time")
    virtual.add_argument(
        "--trials", type=_whole, default=22, metavar="N", help="motions before it rests (default 22)"
    )
    virtual.add_argument("--noise", type=_not_negative, default=1.0, metavar="F", help="factor on noise and bias")
    virtual.add_argument(
        "--quiet-sensors", dest="noise", action="store_const", const=0.0, help="no noise and no bias"
    )
    virtual.add_argument(
        "--imperfect-mounting", action="store_true", help="sensors sit not quite where they should"
    )
    virtual.add_argument(
        "--highpass-hz",
        type=_not_negative,
        metavar="F",
        help="AC-couple all sensors, with this corner (default: as the arm file says)",
    )
    virtual.add_argument("--truth", type=Path, metavar="FILE", help="write the true motion here (.npz) at the end")
    virtual.set_defaults(action=_virtual)
    return parser


def _add_device_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--config", type=Path, metavar="FILE", help="limbd.toml; flags win over it")
    parser.add_argument("--port", metavar="P", help="serial port of the device")
    parser.add_argument("--baud", type=int, metavar="B", help="baud rate (default 12000000)")
    parser.add_argument("--arm", metavar="A", help="arm file or the name of a built-in arm")


def _run(arguments: argparse.Namespace) -> None:
    from daemon.config import load_setup
    from daemon.progress import Progress
    from daemon.stop_signal import StopSignal
    from daemon.supervisor import Supervisor

    setup = load_setup(arguments.config, _given(arguments))
    with StopSignal() as stop, Progress(console) as progress:

        def started(announced: Mapping[str, object]) -> None:
            progress.started(announced)
            if arguments.json:
                emit(json.dumps(announced))

        Supervisor(setup, stop, started, progress.health, progress.trouble).run()


def _check(arguments: argparse.Namespace) -> Mapping[str, object]:
    from daemon.config import load_setup

    try:
        setup = load_setup(arguments.file, {})
    except ConfigError as error:
        if arguments.json:
            emit(json.dumps({"file": str(arguments.file), "ok": False, "mistakes": error.mistakes}))
        raise
    console.print(f"{arguments.file}: no mistakes")
    return {"file": str(arguments.file), "ok": True, "mistakes": [], "arm": setup.arm.name}


def _zero(arguments: argparse.Namespace) -> Mapping[str, object]:
    from daemon.config import load_setup
    from daemon.zero import zero_sensors

    return zero_sensors(load_setup(arguments.config, _given(arguments)), arguments.seconds, arguments.out)


def _virtual(arguments: argparse.Namespace) -> None:
    from arm.arm_file import load_arm
    from daemon.virtual import VirtualOptions, serve
    from daemon.virtual_motion import BenchPlan

    plan = BenchPlan(
        arm=load_arm(arguments.arm),
        seed=arguments.seed,
        rate_hz=arguments.rate_hz,
        trials=arguments.trials,
        noise=arguments.noise,
        imperfect_mounting=arguments.imperfect_mounting,
        highpass_hz=arguments.highpass_hz,
    )
    serve(VirtualOptions(plan, arguments.speed, arguments.link, arguments.truth, arguments.json))


def _given(arguments: argparse.Namespace) -> dict[str, dict[str, object]]:
    """Return the flags that were given, as the config's tables."""
    tables: dict[str, dict[str, object]] = {}
    for flag, (table, key) in _FLAGS.items():
        value = getattr(arguments, flag, None)
        if value is not None:
            tables.setdefault(table, {})[key] = value
    return tables


def _seconds(text: str) -> float:
    value = _not_negative(text)
    if not _SHORTEST_S <= value <= _LONGEST_S:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from {_SHORTEST_S:g} to {_LONGEST_S:g}")
    return value


def _positive(text: str) -> float:
    value = _not_negative(text)
    if value == 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def _not_negative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of at least 0")
    return value


def _whole(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 0")
    return int(text)


if __name__ == "__main__":
    sys.exit(main())
