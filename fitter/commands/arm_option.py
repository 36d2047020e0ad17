"""The arm that a command is given."""

from pathlib import Path

from arm.arm_file import load_arm
from arm.model import Arm
from arm.questions import questions_of
from limbcal.command import ask


def questioned_arm(source: str | Path) -> Arm:
    """Read an arm, and question what in it looks as if it were in another unit.

    Raises
    ------
    ConfigError
        As `arm.arm_file.load_arm` does.
    """
    arm = load_arm(source)
    ask(questions_of(arm, str(source)))
    return arm
