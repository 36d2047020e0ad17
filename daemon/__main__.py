"""`limbd`: the acquisition service and the virtual device."""

import sys

from limbcal.entry import enter

COMMANDS = {
    "run": "acquire, track, publish and record until stopped",
    "status": "how a running daemon is doing: a live view",
    "check": "list every mistake in a config file",
    "zero": "measure the sensors' biases while the arm rests at initial_q_rad",
    "recover": "make a clean file of a recording whose writer was killed",
    "keys": "let clients on other machines in, by their keys",
    "install": "lay down units, udev rule and a first config for systemd",
    "virtual": "be a device: the virtual arm on a pty",
    "compile": "compile the kernels now, so that no other command has to",
}


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    words = "Reads accelerometers from a serial port, tracks the arm, streams it."
    return enter("limbd", words, "daemon.commands", COMMANDS, argv)


if __name__ == "__main__":
    sys.exit(main())
