"""`limbd`: the acquisition service and the virtual device."""

import sys
from types import ModuleType

from daemon.commands import check, install, keys, recover, run, status, virtual, zero
from limbcal.command import Parser, common_options, run_command

COMMANDS: dict[str, tuple[ModuleType, str]] = {
    "run": (run, "acquire, track, publish and record until stopped"),
    "status": (status, "how a running daemon is doing: a live view"),
    "check": (check, "list every mistake in a config file"),
    "zero": (zero, "measure the sensors' biases while the arm rests at initial_q_rad"),
    "recover": (recover, "make a clean file of a recording whose writer was killed"),
    "keys": (keys, "let clients on other machines in, by their keys"),
    "install": (install, "lay down units, udev rule and a first config for systemd"),
    "virtual": (virtual, "be a device: the virtual arm on a pty"),
}


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    parser = Parser(
        prog="limbd", description="Reads accelerometers from a serial port, tracks the arm, streams it."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=Parser)
    for name, (module, sentence) in COMMANDS.items():
        module.add_arguments(commands.add_parser(name, help=sentence, parents=[common_options()]))
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
