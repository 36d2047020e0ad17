"""Where every program begins: nothing is imported before Ctrl-C is one line and no traceback."""

import sys
from collections.abc import Mapping


def enter(prog: str, words: str, package: str, commands: Mapping[str, str], argv: list[str] | None) -> int:
    """Load what commands need, run one and return its exit code.

    Parameters
    ----------
    prog, words, package, commands
        As of `limbcal.arguments.parser_of`.
    argv : list of str or None
        The arguments; those of this process with None.
    """
    try:
        from limbcal.arguments import parser_of  # noqa: PLC0415 - what takes a moment to load
        from limbcal.command import run_command  # noqa: PLC0415

        return run_command(parser_of(prog, words, package, commands), argv)
    except KeyboardInterrupt:  # while modules were loaded, or for the second time while a command ended
        sys.stderr.write("stopped\n")
        return 0
