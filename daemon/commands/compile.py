"""`limbd compile`."""

import argparse

#: As it stands in the help.
EXAMPLE = "limbd compile"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.set_defaults(action=compile_kernels)


def compile_kernels(_arguments: argparse.Namespace) -> dict[str, object]:
    """Compile what the virtual device, the reception and the trackers of `limbd run` need."""
    from daemon.service.kernels import compile_all
    from limbcal.compilation import said_when_compiling

    with said_when_compiling("limbd") as compilation:
        compile_all()
    return compilation.document()
