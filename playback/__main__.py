"""The `limbplay` command."""

import argparse
import sys

from limbcal.command import Parser, common_options, run_command
from playback.commands import export, send, serve, touch, view


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of `limbplay` with all its commands."""
    parser: argparse.ArgumentParser = Parser(prog="limbplay", description="Play motion back as a stream.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, words, add_arguments in (
        ("serve", "stream a recorded or simulated motion as limb/play", serve.add_arguments),
        ("view", "show the arm in a browser, with its twin and the controls", view.add_arguments),
        ("export", "write a motion as glTF, CSV, MP4, GIF, or MCAP for Foxglove", export.add_arguments),
        ("touch", "simulate the arm in real time and let a haptic device feel it", touch.add_arguments),
        ("send", "ask a running playback for something", send.add_arguments),
    ):
        add_arguments(commands.add_parser(name, parents=[common_options()], help=words, description=words))
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run `limbplay` and return its exit code."""
    return run_command(build_parser(), argv)


if __name__ == "__main__":
    sys.exit(main())
