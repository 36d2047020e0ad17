"""`limbd`: the acquisition service and the virtual device."""

import argparse
import json
import math
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from daemon.fault_schedule import KINDS, faults_of
from limbcal.command import Parser, common_options, console, emit, run_command
from limbcal.errors import ConfigError

# What a subcommand needs is imported where it runs: every process of `limbd run` loads this module first, and
# only one of them has a use for the tracker's compiler.
# ruff: noqa: PLC0415

AddCommand = Callable[..., argparse.ArgumentParser]
DEFAULT_ENDPOINT = "tcp://127.0.0.1:5770"
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
    run.add_argument("--wait", action="store_true", help="wait for a device that is not there yet")
    run.add_argument("--method", metavar="M", help="how motion is tracked: filter (default) or integrate")
    run.add_argument("--endpoint", metavar="E", help=f"where to publish (default {DEFAULT_ENDPOINT})")
    run.add_argument("--record", metavar="DIR", help="record into this directory")
    run.add_argument("--replay", type=Path, metavar="FILE", help="play a recording in place of a device")
    run.add_argument("--speed", type=_positive, default=1.0, metavar="X", help="of --replay: times as fast")
    run.set_defaults(action=_run)

    _add_tools(commands.add_parser, common)
    _add_virtual(commands.add_parser, common)
    return parser


def _add_tools(add_command: AddCommand, common: argparse.ArgumentParser) -> None:
    check = add_command("check", parents=[common], help="list every mistake in a config file")
    check.add_argument("file", type=Path, metavar="FILE")
    check.set_defaults(action=_check)

    zero = add_command(
        "zero", parents=[common], help="measure the sensors' biases while the arm rests at initial_q_rad"
    )
    _add_device_options(zero)
    zero.add_argument("--seconds", type=_seconds, default=2.0, metavar="S", help="how long to measure (default 2)")
    zero.add_argument("--out", type=Path, metavar="FILE", help="where the arm goes (default: its own file)")
    zero.set_defaults(action=_zero)

    recovery = add_command(
        "recover", parents=[common], help="make a clean file of a recording whose writer was killed"
    )
    recovery.add_argument("file", type=Path, metavar="FILE")
    recovery.add_argument("--out", type=Path, metavar="FILE", help="default NAME.recovered.mcap beside it")
    recovery.set_defaults(action=_recover)

    keys = add_command("keys", parents=[common], help="let clients on other machines in, by their keys")
    keys.add_argument("what", choices=["new"], help="new: make a key for one more client")
    keys.add_argument("name", metavar="NAME")
    keys.add_argument("--dir", type=Path, default=Path("keys"), metavar="DIR", help="publish.keys (default keys)")
    keys.add_argument("--out", type=Path, metavar="FILE", help="what the client gets (default NAME.limbkey)")
    keys.set_defaults(action=_keys)

    setup = add_command(
        "install", parents=[common], help="lay down units, udev rule and a first config for systemd"
    )
    setup.add_argument("--prefix", type=Path, default=Path("/"), metavar="DIR", help="root to install under")
    setup.add_argument("--dry-run", action="store_true", help="only say what would be done")
    setup.add_argument("--remove", action="store_true", help="take away what was laid down; configs stay")
    setup.set_defaults(action=_install)

    status = add_command("status", parents=[common], help="how a running daemon is doing: a live view")
    status.add_argument("--endpoint", default=DEFAULT_ENDPOINT, metavar="E", help=f"default {DEFAULT_ENDPOINT}")
    status.add_argument("--key", type=Path, metavar="FILE", help="NAME.limbkey, where the daemon asks for one")
    status.add_argument("--once", action="store_true", help="one report and no more")
    status.set_defaults(action=_status)


def _add_virtual(add_command: AddCommand, common: argparse.ArgumentParser) -> None:
    virtual = add_command("virtual", parents=[common], help="be a device: the virtual arm on a pty")
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
    virtual.add_argument(
        "--fault",
        default="",
        metavar="SCHEDULE",
        help="what goes wrong and when, as in 'unplug@5+1/3, flip@0+60*1e-5'; kinds: " + ", ".join(KINDS),
    )
    virtual.add_argument("--truth", type=Path, metavar="FILE", help="write the true motion here (.npz) at the end")
    virtual.set_defaults(action=_virtual)


def _add_device_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--config", type=Path, metavar="FILE", help="limbd.toml; flags win over it")
    parser.add_argument("--port", metavar="P", help="serial port of the device")
    parser.add_argument("--baud", type=int, metavar="B", help="baud rate (default 12000000)")
    parser.add_argument("--arm", metavar="A", help="arm file or the name of a built-in arm")


def _run(arguments: argparse.Namespace) -> None:
    from daemon.config import load_setup, replayed_setup
    from daemon.progress import Progress
    from daemon.stop_signal import StopSignal
    from daemon.supervisor import Supervisor

    if arguments.replay is None:
        setup = load_setup(arguments.config, _given(arguments))
    else:
        _no_device(arguments)
        setup = replayed_setup(arguments.replay, _given(arguments), arguments.speed)
    with StopSignal() as stop, Progress(console) as progress:

        def started(announced: Mapping[str, object]) -> None:
            progress.started(announced)
            if arguments.json:
                emit(json.dumps(announced))

        Supervisor(setup, stop, started, progress.health, progress.trouble, wait=arguments.wait).run()


def _no_device(arguments: argparse.Namespace) -> None:
    given = [f"--{name}" for name in ("port", "baud", "config") if getattr(arguments, name) is not None]
    if given:
        raise ConfigError(f"--replay has its own device and config: expected it without {' and '.join(given)}")


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


def _recover(arguments: argparse.Namespace) -> Mapping[str, object]:
    from daemon.recover import recover

    return recover(arguments.file, arguments.out)


def _keys(arguments: argparse.Namespace) -> Mapping[str, object]:
    from protocol.curve import new_client

    out = new_client(arguments.dir, arguments.name, arguments.out)
    console.print(f"{out}: give it to {arguments.name}; the daemon lets it in from its next start on")
    return {"client": arguments.name, "key": str(out), "keys": str(arguments.dir)}


def _install(arguments: argparse.Namespace) -> Mapping[str, object]:
    from daemon.install import install

    return install(arguments.prefix, arguments.dry_run, arguments.remove)


def _status(arguments: argparse.Namespace) -> None:
    from daemon.status import status

    status(arguments.endpoint, arguments.key, arguments.once, arguments.json)


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
    faults = faults_of(arguments.fault)
    serve(VirtualOptions(plan, arguments.speed, arguments.link, arguments.truth, arguments.json, faults))


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
