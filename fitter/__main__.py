"""`fitter`: recordings and streams in, calibrated arms out."""

import sys

import fitter.single_thread  # noqa: F401 - before all that loads numpy
from limbcal.entry import enter

COMMANDS = {
    "subscribe": "follow the daemon and calibrate the arm while it moves",
    "track": "accelerations, or markers, to joint motion",
    "sensors": "ordinary motions to what the sensors read and where they sit",
    "markers": "what a C3D or TRC file holds, and what is wrong with it",
    "marker-set": "a recording of markers to a draft of a marker set",
    "kinematics": "joint angles and a measured tip, or a person's markers, to the arm's geometry",
    "sums": "trials of any length to sums that add up, for `fitter dynamics`",
    "dynamics": "motion and torque to dynamic parameters",
    "torque": "a motion to the joint torques that it needs",
    "diagnose": "what the simulation gets wrong, why, and the gain of putting it right",
    "excite": "a reference that reveals the dynamic parameters",
    "simulate": "the motion of a calibrated arm",
    "effects": "what a simulation may get wrong, and by what it is known",
    "reproduce": "the paper's experiments, side by side with its numbers",
    "compile": "compile the kernels now, so that no other command has to",
}


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    words = "Learn an arm's kinematics and dynamics from its motion."
    return enter("fitter", words, "fitter.commands", COMMANDS, argv)


if __name__ == "__main__":
    sys.exit(main())
