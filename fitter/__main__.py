"""`fitter`: recordings and streams in, calibrated arms out."""

import sys
from types import ModuleType

import fitter.single_thread  # noqa: F401 - before all that loads numpy
from fitter.commands import (
    diagnose,
    dynamics,
    effects,
    excite,
    kinematics,
    reproduce,
    sensors,
    simulate,
    subscribe,
    sums,
    track,
)
from limbcal.command import Parser, common_options, run_command

COMMANDS: dict[str, tuple[ModuleType, str]] = {
    "subscribe": (subscribe, "follow the daemon and calibrate the arm while it moves"),
    "track": (track, "accelerations to joint motion"),
    "sensors": (sensors, "ordinary motions to what the sensors read and where they sit"),
    "kinematics": (kinematics, "joint angles and a measured tip to the arm's geometry"),
    "sums": (sums, "trials of any length to sums that add up, for `fitter dynamics`"),
    "dynamics": (dynamics, "motion and torque to dynamic parameters"),
    "diagnose": (diagnose, "what the simulation gets wrong, why, and the gain of putting it right"),
    "excite": (excite, "a reference that reveals the dynamic parameters"),
    "simulate": (simulate, "the motion of a calibrated arm"),
    "effects": (effects, "what a simulation may get wrong, and by what it is known"),
    "reproduce": (reproduce, "the paper's experiments, side by side with its numbers"),
}


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    parser = Parser(prog="fitter", description="Learn an arm's kinematics and dynamics from its motion.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=Parser)
    for name, (module, sentence) in COMMANDS.items():
        module.add_arguments(
            commands.add_parser(name, help=sentence, description=sentence, parents=[common_options()])
        )
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
