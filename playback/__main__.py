"""`limbplay`: motion back out, to look at and to touch."""

import sys

from limbcal.entry import enter

COMMANDS = {
    "serve": "stream a recorded or simulated motion as limb/play",
    "view": "show the arm in a browser, with its twin and the controls",
    "export": "write a motion as glTF, CSV, MP4, GIF, or MCAP for Foxglove",
    "touch": "simulate the arm in real time and let a haptic device feel it",
    "send": "ask a running playback for something",
    "compile": "compile the kernels now, so that no other command has to",
}


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    return enter("limbplay", "Play motion back as a stream.", "playback.commands", COMMANDS, argv)


if __name__ == "__main__":
    sys.exit(main())
